"""Planning requests: answered, streamed, stopped, refused; workers that die cost one request."""

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from in_process import InProcessClient, serving
from scripted_fleet import map_json, walls
from test_mission_events import stream
from travelling import DOMAIN, problem

import planner
from service.app import create_app
from service.settings import Settings, sqlite_url

WAIT = {"Prefer": "wait=30"}


@pytest.fixture(scope="module")
def client() -> Iterator[InProcessClient]:
    settings = Settings(database_url="sqlite://", planning_processes=1, planning_queue=2)
    with serving(create_app(settings)) as started:
        yield started


def request(places: int, **more: Any) -> dict[str, Any]:
    return {"domain_text": DOMAIN, "problem": problem(places), "time_limit_s": 20.0, **more}


def endless(**more: Any) -> dict[str, Any]:
    """Far from proved optimal when the time is up."""
    return request(30, time_limit_s=60.0, **more)


def workers(client: InProcessClient) -> list[int]:
    """Process ids of this application's planning workers."""
    pool = client.app.state.planning_requests._executor
    return [worker.process.pid for worker in pool.workers()]


def test_a_plan_is_waited_for(client: InProcessClient) -> None:
    answer = client.post("/v1/plans", json=request(4), headers=WAIT)
    assert answer.status_code == 200, answer.text
    result = answer.json()
    assert result["status"] == "finished"
    assert result["outcome"].startswith("solved")
    assert result["validated"] is True
    assert result["lower_bound"] <= result["plan"]["makespan"] + 1e-6
    verdict = planner.validate(DOMAIN, problem(4), result["plan"]["text"])
    assert verdict.valid
    assert verdict.makespan == pytest.approx(result["plan"]["makespan"], abs=0.01)


def test_improving_plans_are_streamed_and_resumed(client: InProcessClient) -> None:
    answer = client.post("/v1/plans", json=request(12, time_limit_s=1.0))
    assert answer.status_code == 202
    assert "Retry-After" in answer.headers
    url = answer.headers["location"]
    events = stream(client, url)
    assert [int(event["id"]) for event in events] == list(range(len(events)))
    assert events[-1]["event"] == "finished"
    makespans = [event["data"]["makespan"] for event in events[:-1]]
    assert makespans
    assert makespans == sorted(makespans, reverse=True)
    assert stream(client, url, **{"Last-Event-ID": "0"}) == events[1:]
    result = client.get(url).json()
    assert result["plans_found"] == len(makespans)
    assert result["plan"]["makespan"] == makespans[-1]


def test_deleting_stops_it_and_frees_the_worker(client: InProcessClient) -> None:
    url = client.post("/v1/plans", json=endless()).headers["location"]
    while client.get(url).json()["plans_found"] == 0:
        time.sleep(0.02)
    stopped = client.delete(url).json()
    assert stopped["status"] == "canceled"
    assert stopped["plan"] is not None
    assert client.delete(url).json()["status"] == "canceled"
    assert client.post("/v1/plans", json=request(4), headers=WAIT).status_code == 200


def test_a_request_that_waits_can_be_canceled(client: InProcessClient) -> None:
    running = client.post("/v1/plans", json=endless()).headers["location"]
    waiting = client.post("/v1/plans", json=endless()).headers["location"]
    assert client.delete(waiting).json()["status"] == "canceled"
    assert client.delete(running).json()["status"] == "canceled"


def test_a_full_queue_says_when_to_come_again(client: InProcessClient) -> None:
    accepted = []
    while (answer := client.post("/v1/plans", json=endless())).status_code == 202:
        accepted.append(answer.headers["location"])
        time.sleep(0.05)
    assert answer.status_code == 429
    assert answer.headers["retry-after"]
    assert len(accepted) == 3
    for url in accepted:
        client.delete(url)


def test_a_worker_that_dies_costs_one_request(client: InProcessClient) -> None:
    url = client.post("/v1/plans", json=endless()).headers["location"]
    while client.get(url).json()["plans_found"] == 0:
        time.sleep(0.02)
    (pid,) = workers(client)
    os.kill(pid, signal.SIGKILL)
    events = stream(client, url)
    assert events[-1]["event"] == "failed"
    assert events[-1]["data"]["outcome"] == "crashed"
    again = client.post("/v1/plans", json=request(4), headers=WAIT)
    assert again.json()["status"] == "finished"
    assert client.get("/healthz").status_code == 200


def test_faults_in_pddl_have_line_and_column(client: InProcessClient) -> None:
    faulty = problem(3).replace("(at r0 p0)", "(att r0 p0)")
    answer = client.post("/v1/plans", json={"domain_text": DOMAIN, "problem": faulty})
    assert answer.status_code == 422
    (finding, *_) = answer.json()["diagnostics"]
    assert finding["location"] == "/problem"
    line = faulty.splitlines()[finding["line"] - 1]
    assert line[finding["column"] - 1 :].startswith("att")
    assert "^" in finding["rendered"]


@pytest.mark.parametrize(
    ("body", "where"),
    [
        ({"problem": "(define)"}, ""),
        ({"domain": "disaster", "domain_text": DOMAIN, "problem": ""}, ""),
        ({"domain": "../../etc/passwd", "problem": ""}, "/domain"),
        ({"domain": "unheard-of", "problem": ""}, "/domain"),
        ({"domain_text": "/etc/passwd", "problem": ""}, "/domain_text"),
        ({"domain_text": DOMAIN, "problem": "/etc/passwd"}, "/problem"),
        ({"domain_text": DOMAIN, "problem": problem(3), "time_limit_s": 1e9}, "/time_limit_s"),
        ({"domain_text": DOMAIN, "problem": "(" * 3_000_000}, "/problem"),
    ],
)
def test_what_cannot_be_planned_is_refused_with_the_place(
    client: InProcessClient, body: dict[str, Any], where: str
) -> None:
    answer = client.post("/v1/plans", json=body)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["location"] == where
    assert "root:" not in answer.text


def test_a_domain_with_attachments_plans_on_a_map(client: InProcessClient) -> None:
    hall = walls(["########", "#......#", "#......#", "########"])
    text = """
(define (problem hall) (:domain disaster)
  (:objects e - explorer here - free_location t - mission_target)
  (:init (at e here) (= (x here) 1.5) (= (y here) 1.5) (= (x t) 6.5) (= (y t) 1.5)
         (= (speed e) 1) (= (radius e) 0.3))
  (:goal (explored t)))
"""
    body = {"domain": "disaster", "problem": text}
    refused = client.post("/v1/plans", json=body)
    assert refused.json()["errors"][0]["location"] == "/map"
    result = client.post("/v1/plans", json={**body, "map": map_json(hall)}, headers=WAIT).json()
    assert result["plan"]["makespan"] == pytest.approx(5.0, abs=0.01)


def test_a_request_is_taken_up_again_after_a_restart(tmp_path: Path) -> None:
    settings = Settings(database_url=sqlite_url(tmp_path / "plans.sqlite"), planning_processes=1)
    with serving(create_app(settings)) as first:
        url = first.post("/v1/plans", json=request(12, time_limit_s=1.0)).headers["location"]
    with serving(create_app(settings)) as second:
        events = stream(second, url)
        assert events[-1]["event"] == "finished"
        assert second.get(url).json()["validated"] is True


def test_the_same_key_gives_the_same_request(client: InProcessClient) -> None:
    key = {"Idempotency-Key": "friday"}
    first = client.post("/v1/plans", json=request(3), headers={**WAIT, **key})
    again = client.post("/v1/plans", json=request(3), headers={**WAIT, **key})
    assert again.headers["location"] == first.headers["location"]
    assert again.json() == first.json()
    other = client.post("/v1/plans", json=request(4), headers=key)
    assert other.status_code == 422
    assert other.json()["type"].endswith("idempotency-key-reused")
