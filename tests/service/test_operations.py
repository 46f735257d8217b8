"""Health, readiness, metrics, audit log."""

import json
import logging

import pytest
from in_process import serving
from test_mission_loop import ROOMS, TARGETS, drive, fleet

from service.app import create_app
from service.settings import Settings


def test_metrics_count_what_happened(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, logger="service.audit")
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        assert "marsupial_missions_open 1.0" in client.get("/metrics").text
        drive(client, url, team)
        assert client.get("/readyz").json() == {"status": "ready"}
        text = client.get("/metrics").text
    values = dict(line.rsplit(" ", 1) for line in text.splitlines() if not line.startswith("#"))
    reports = (
        'marsupial_http_request_seconds_count{method="POST",'
        'route="/v1/missions/{mission_id}/reports",status="200"}'
    )
    assert float(values[reports]) == team.sequence
    assert float(values["marsupial_missions_open"]) == 0.0
    assert float(values['marsupial_replanning_seconds_count{outcome="new plan"}']) >= 3.0
    records = [record for record in caplog.records if record.name == "service.audit"]
    audited = [json.loads(record.message) for record in records]
    assert [(entry["method"], entry["status"]) for entry in audited] == [("POST", 201)]
