"""Whatever a client sends within or beyond the OpenAPI document, no answer is a 5xx."""

import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import uvicorn
from in_process import serving

from service.app import create_app
from service.examples import EXAMPLES
from service.routes.scans import MEDIA_TYPE
from service.settings import Settings


@contextmanager
def listening() -> Iterator[str]:
    """The service on a port of its own."""
    app = create_app(Settings(database_url="sqlite://", planning_processes=1, max_wait_s=0.2))
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_config=None, lifespan="on"))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            time.sleep(0.01)
        port = server.servers[0].sockets[0].getsockname()[1]
        yield f"http://127.0.0.1:{port}"
    finally:
        server.should_exit = True
        thread.join()


def test_the_document_describes_every_body() -> None:
    openapi = create_app(Settings(database_url="sqlite://")).openapi()
    for path, operations in openapi["paths"].items():
        for method, operation in operations.items():
            if method in ("post", "put"):
                assert "requestBody" in operation, f"{method} {path}"
            assert operation["summary"]
    names = set(openapi["components"]["schemas"])
    assert {"MissionRequest", "Report", "ReportAnswer", "PlanSubmission", "DomainUpload"} <= names
    references = {
        text.rsplit("/", 1)[1] for text in _references(openapi) if "#/components/schemas/" in text
    }
    assert references <= names


def _references(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        for key, value in node.items():
            if key == "$ref":
                yield value
            else:
                yield from _references(value)
    elif isinstance(node, list):
        for value in node:
            yield from _references(value)


def test_every_body_has_an_example_that_the_service_accepts() -> None:
    app = create_app(Settings(database_url="sqlite://", planning_processes=1))
    document = app.openapi()
    with serving(app) as client:
        mission = client.post("/v1/missions", json=EXAMPLES["MissionRequest"]).json()["id"]
        names = {"mission_id": mission, "name": "example", "plan_id": "x"}
        names |= {"planner_name": "marsupial", "service": "solve"}
        # In this order: a cut-off mission would refuse what comes after it.
        for path, operations in document["paths"].items():
            for method, operation in operations.items():
                content = operation.get("requestBody", {}).get("content", {})
                if "application/json" not in content:
                    continue
                media = content["application/json"]
                assert "example" in media, f"{method} {path}"
                url = path.format(**names)
                answer = client.request(method.upper(), url, json=media["example"])
                assert answer.status_code in (200, 201, 202), f"{method} {path}: {answer.text}"
                if not path.startswith(("/v1", "/check")):
                    assert "rror" not in answer.text.replace('"error":""', ""), answer.text


def test_links_lead_to_operations_with_these_parameters() -> None:
    document = create_app(Settings(database_url="sqlite://")).openapi()
    operations = {
        operation["operationId"]: (path, operation)
        for path, methods in document["paths"].items()
        for operation in methods.values()
    }
    assert len(operations) == sum(len(methods) for methods in document["paths"].values())
    count = 0
    for methods in document["paths"].values():
        for operation in methods.values():
            for answer in operation["responses"].values():
                for link in answer.get("links", {}).values():
                    path, _ = operations[link["operationId"]]
                    assert set(re.findall(r"{(\w+)}", path)) == set(link["parameters"])
                    count += 1
    assert count > 15


@pytest.mark.slow
def test_no_request_makes_the_service_fail(tmp_path: Path) -> None:
    # Scans are bytes of a format of their own.
    (tmp_path / "hooks.py").write_text(
        "import schemathesis\n"
        f"schemathesis.serializer.alias({MEDIA_TYPE!r}, 'application/octet-stream')\n",
        encoding="utf-8",
    )
    with listening() as url:
        result = subprocess.run(
            [
                *(sys.executable, "-m", "schemathesis.cli", "run", f"{url}/openapi.json"),
                *("--checks", "not_a_server_error", "--phases", "coverage,fuzzing,stateful"),
                *("--max-examples", "30", "--seed", "1", "--exclude-path-regex", "/events$"),
                *("--request-timeout", "20"),
            ],
            cwd=tmp_path,
            env={**os.environ, "SCHEMATHESIS_HOOKS": "hooks", "PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )
    assert result.returncode == 0, result.stdout[-5000:] + result.stderr[-2000:]
