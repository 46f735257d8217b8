"""Requests as PDDL editors send them, and the answers their clients read."""

import json
import time
from collections.abc import Iterator
from typing import Any

import pytest
from in_process import InProcessClient, serving
from travelling import DOMAIN, problem

from service.app import create_app
from service.settings import Settings

PROBLEM = problem(4)


@pytest.fixture(scope="module")
def client() -> Iterator[InProcessClient]:
    with serving(create_app(Settings(database_url="sqlite://", planning_processes=1))) as started:
        yield started


def test_planning_as_a_service_as_planutils_remote_does_it(client: InProcessClient) -> None:
    packages = client.get("/package").json()
    service = packages["marsupial"]["endpoint"]["services"]["solve"]
    arguments = {argument["name"] for argument in service["args"]}
    named = {part[1:-1] for part in service["call"].split(" ")[1:]}
    assert named == arguments == {"domain", "problem", "time_limit", "seed"}
    # Options come as text; the result's address is glued on with another slash.
    body = {"domain": DOMAIN, "problem": PROBLEM, "time_limit": "5", "seed": "1"}
    asked = client.post("/package/marsupial/solve", json=body).json()
    where = f"/{asked['result']}"
    assert where.startswith("//check/")
    for _ in range(200):
        answer = client.get(f"http://service{where}").json()
        if answer["status"] == "ok":
            break
        assert answer == {"status": "PENDING"}
        time.sleep(0.05)
    result = answer["result"]
    assert set(result) == {"stdout", "stderr", "call", "output", "output_type"}
    assert "(go r" in result["output"]["plan"]
    adapted = client.post(where[1:], json={"adaptor": "planning_editor_adaptor"}).json()
    (plan,) = adapted["plans"]
    assert plan["status"] == "ok"
    assert plan["result"]["parse_status"] == "ok"
    assert plan["result"]["length"] == len(plan["result"]["plan"])
    assert all(step["name"] in step["action"] for step in plan["result"]["plan"])


def test_errors_come_with_200_where_clients_read_nothing_else(client: InProcessClient) -> None:
    body = {"domain": DOMAIN, "problem": PROBLEM}
    for path, sent in (
        ("/package/other/solve", body),
        ("/package/marsupial/dance", body),
        ("/package/marsupial/solve", {**body, "domain": "(define"}),
    ):
        answer = client.post(path, json=sent)
        assert answer.status_code == 200
        assert set(answer.json()) == {"Error"}
    assert "Error" in client.get("/check/none").json()


def test_solve(client: InProcessClient) -> None:
    answer = client.post("/solve", json={"domain": DOMAIN, "problem": PROBLEM}).json()
    assert answer["status"] == "ok"
    steps = answer["result"]["plan"]
    assert {"name", "time", "duration"} == set(steps[0])
    assert max(step["time"] + step["duration"] for step in steps) > 0
    refused = client.post("/solve", json={"domain": DOMAIN, "problem": "(define"}).json()
    assert refused["status"] == "error"
    assert refused["result"]["error"]


@pytest.mark.parametrize("asynchronous", [False, True])
def test_request(client: InProcessClient, *, asynchronous: bool) -> None:
    body = {
        "domain": {"name": "errands", "format": "PDDL", "content": DOMAIN},
        "problem": {"name": "round", "format": "PDDL", "content": PROBLEM},
        "configuration": {"planFormat": "JSON", "timeout": 5},
    }
    answer = client.post(f"/request?async={str(asynchronous).lower()}", json=body).json()
    for _ in range(200):
        if answer["status"]["status"] == "STOPPED":
            break
        assert asynchronous
        assert answer["status"]["status"] == "SEARCHING_BETTER_PLAN"
        time.sleep(0.05)
        answer = client.get(f"/request/{answer['requestId']}").json()
    (plan,) = answer["plans"]
    assert plan["timeUnit"] == "SECOND"
    assert plan["format"] == "json"
    steps = json.loads(plan["content"])
    ends = [step["time"] + step["duration"] for step in steps]
    assert max(ends) == pytest.approx(plan["makespan"], abs=0.01)
    assert set(plan["searchPerformanceInfo"]) == {"statesEvaluated", "timeElapsed"}


def test_a_request_with_faults_fails_with_a_message(client: InProcessClient) -> None:
    body: dict[str, Any] = {"domain": {"content": DOMAIN}, "problem": {"content": "(define"}}
    answer = client.post("/request", json=body)
    assert answer.status_code == 200
    assert answer.json()["status"]["status"] == "FAILED"
    assert answer.json()["status"]["error"]["message"]


def test_parse(client: InProcessClient) -> None:
    assert client.post("/parse", json={"domain": DOMAIN, "problems": [PROBLEM]}).json() == []
    faulty = PROBLEM.replace("(done p1)", "(don p1)")
    (finding,) = client.post(
        "/parse", json={"domain": DOMAIN, "problems": [PROBLEM, faulty]}
    ).json()
    assert finding["location"] == "PROBLEM:1"
    assert finding["severity"] == "error"
    line = faulty.splitlines()[finding["position"]["line"] - 1]
    assert line[finding["position"]["character"] - 1 :].startswith("don")
    broken = client.post("/parse", json={"domain": "(define", "problems": []}).json()
    assert broken[0]["location"] == "DOMAIN"


def test_validate(client: InProcessClient) -> None:
    body = {"domain": DOMAIN, "problem": PROBLEM}
    plan = client.post("/solve", json=body).json()["result"]["output"]
    valid = client.post("/validate", json={**body, "plan": plan}).json()["validation"]
    assert valid == {"problems": []}
    short = "\n".join(plan.strip().splitlines()[:1])
    invalid = client.post("/validate", json={**body, "plan": short}).json()["validation"]
    assert invalid["error"]
    assert invalid["problems"][0]["severity"] == "error"
    unread = client.post("/validate", json={**body, "plan": "(("}).json()["validation"]
    assert unread["problems"][0]["location"] == "PLAN"


BODIES: dict[str, Any] = {
    "/solve": lambda answer: answer["result"]["error"],
    "/request": lambda answer: answer["status"]["error"]["message"],
    "/package/marsupial/solve": lambda answer: answer["Error"],
    "/parse": lambda answer: answer[0]["message"],
    "/validate": lambda answer: answer["validation"]["error"],
    "/check/x": lambda answer: answer["Error"],
}


@pytest.mark.parametrize("path", sorted(BODIES))
def test_a_body_cut_off_by_a_client_that_counts_characters_is_explained(
    client: InProcessClient, path: str
) -> None:
    text = json.dumps(
        {"domain": "; größte Fläche\n" + DOMAIN, "problem": PROBLEM}, ensure_ascii=False
    )
    cut = text.encode()[: len(text)]
    answer = client.post(path, content=cut)
    assert answer.status_code == 200
    assert "Content-Length" in BODIES[path](answer.json())


@pytest.mark.parametrize("path", sorted(set(BODIES) - {"/check/x"}))
def test_a_body_without_its_members_is_explained(client: InProcessClient, path: str) -> None:
    answer = client.post(path, json={})
    assert answer.status_code == 200
    assert "domain" in BODIES[path](answer.json())
