"""A whole service on each executor: a mission is completed, a planning request answered."""

from typing import Any

import pytest
from in_process import serving
from test_mission_loop import ROOMS, TARGETS, drive, fleet
from test_plans import WAIT, request
from typer.testing import CliRunner

from service.app import create_app
from service.settings import Settings

EXECUTORS = ["processes", "threads", pytest.param("ray", marks=pytest.mark.slow)]


@pytest.mark.parametrize("executor", EXECUTORS)
def test_missions_and_requests_are_planned(executor: Any) -> None:
    if executor == "ray":
        pytest.importorskip("ray", reason="Ray is not installed (extra marsupial[cluster])")
    settings = Settings(
        database_url="sqlite://", executor=executor, planning_workers=1, planning_processes=1
    )
    team = fleet()
    with serving(create_app(settings)) as client:
        body = team.mission(ROOMS, TARGETS, strategy="planner")
        url = client.post("/v1/missions", json=body).headers["location"]
        assert drive(client, url, team) == "completed"
        kinds = [decision["kind"] for decision in client.get(url).json()["decisions"]]
        assert "no plan" not in kinds
        planned = client.post("/v1/plans", json=request(4), headers=WAIT)
        assert planned.json()["validated"] is True
        metrics = client.get("/metrics").text
        assert 'marsupial_planning_wait_seconds_count{kind="request"} 1.0' in metrics


def test_an_executor_that_is_none_gets_a_sentence() -> None:
    from test_serve import command

    result = CliRunner().invoke(command(), ["--executor", "pigeons"])
    assert result.exit_code == 36
    assert "processes, threads, ray" in result.output
