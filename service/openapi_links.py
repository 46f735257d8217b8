"""Links of the OpenAPI document: what to do next with what an answer holds (OpenAPI 3.1)."""

from typing import Any

Target = tuple[str, str, dict[str, str]]
"""Method, path, and where its parameters come from."""

_MISSION = {"mission_id": "$response.body#/id"}
_SAME_MISSION = {"mission_id": "$request.path.mission_id"}
_PLAN = {"plan_id": "$response.body#/id"}

LINKS: dict[tuple[str, str, str], dict[str, Target]] = {
    ("post", "/v1/missions", "201"): {
        "mission": ("get", "/v1/missions/{mission_id}", _MISSION),
        "report": ("post", "/v1/missions/{mission_id}/reports", _MISSION),
        "plan": ("get", "/v1/missions/{mission_id}/plan", _MISSION),
        "map": ("get", "/v1/missions/{mission_id}/map", _MISSION),
        "add a target": ("post", "/v1/missions/{mission_id}/targets", _MISSION),
        "add a robot": ("post", "/v1/missions/{mission_id}/robots", _MISSION),
        "instruct": ("post", "/v1/missions/{mission_id}/instructions", _MISSION),
        "cancel": ("delete", "/v1/missions/{mission_id}", _MISSION),
    },
    ("post", "/v1/missions/{mission_id}/reports", "200"): {
        "plan": ("get", "/v1/missions/{mission_id}/plan", _SAME_MISSION),
    },
    ("post", "/v1/missions/{mission_id}/instructions", "201"): {
        "withdraw": (
            "delete",
            "/v1/missions/{mission_id}/instructions/{instruction_id}",
            {**_SAME_MISSION, "instruction_id": "$response.body#/instructions/0/id"},
        ),
    },
    ("post", "/v1/missions/{mission_id}/targets", "201"): {
        "remove": (
            "delete",
            "/v1/missions/{mission_id}/targets/{target_id}",
            {**_SAME_MISSION, "target_id": "$request.body#/id"},
        ),
    },
    ("post", "/v1/missions/{mission_id}/robots", "201"): {
        "leave": (
            "delete",
            "/v1/missions/{mission_id}/robots/{robot_id}",
            {**_SAME_MISSION, "robot_id": "$request.body#/id"},
        ),
    },
    ("post", "/v1/plans", "202"): {
        "result": ("get", "/v1/plans/{plan_id}", _PLAN),
        "cancel": ("delete", "/v1/plans/{plan_id}", _PLAN),
    },
    **{
        ("put", f"/v1/{plural}/{{name}}", "201"): {
            "current version": ("get", f"/v1/{plural}/{{name}}", {"name": "$request.path.name"}),
            "this version": (
                "get",
                f"/v1/{plural}/{{name}}/versions/{{version}}",
                {"name": "$request.path.name", "version": "$response.body#/version"},
            ),
            "missions": (
                "get",
                f"/v1/{plural}/{{name}}/missions",
                {"name": "$request.path.name"},
            ),
            "forget": ("delete", f"/v1/{plural}/{{name}}", {"name": "$request.path.name"}),
        }
        for plural in ("domains", "maps")
    },
}


def add_links(document: dict[str, Any]) -> None:
    """Adds the links to a document whose operations have ids."""
    paths = document["paths"]
    for (method, path, status), targets in LINKS.items():
        answer = paths[path][method]["responses"][status]
        answer["links"] = {
            name.replace(" ", "-"): {
                "operationId": paths[to_path][to_method]["operationId"],
                "parameters": parameters,
            }
            for name, (to_method, to_path, parameters) in targets.items()
        }
