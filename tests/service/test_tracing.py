"""One trace from a fleet's report through the replan to the worker; nothing without an endpoint."""

import json
import logging
from collections.abc import Sequence

import pytest
from in_process import serving
from odd_work import OddWork
from opentelemetry import trace
from test_mission_loop import ROOMS, TARGETS, WAIT, fleet
from test_plans import request
from test_worker_pool import ending, submit

from service.app import create_app
from service.commands.serve import JsonLines
from service.jobs.process_pool import process_pool
from service.jobs.worker_pool import PoolParameters
from service.settings import Settings
from service.tracing import continued, trace_id, traceparent

sdk = pytest.importorskip(
    "opentelemetry.sdk.trace", reason="the extra marsupial[telemetry] is not installed"
)
TRACE = "0af7651916cd43dd8448eb211c80319c"
PARENT = f"00-{TRACE}-b7ad6b7169203331-01"


def test_a_report_and_all_that_it_causes_are_one_trace() -> None:
    from opentelemetry.sdk.trace.export import SimpleSpanProcessor
    from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter

    exporter = InMemorySpanExporter()
    provider = sdk.TracerProvider()
    provider.add_span_processor(SimpleSpanProcessor(exporter))
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"), provider)) as client:
        body = team.mission(ROOMS, TARGETS, strategy="planner")
        url = client.post("/v1/missions", json=body).headers["location"]
        headers = {**WAIT, "traceparent": PARENT}
        assert client.post(f"{url}/reports", json=team.report(), headers=headers).is_success
        headers = {"Prefer": "wait=30", "traceparent": PARENT}
        assert client.post("/v1/plans", json=request(3), headers=headers).status_code == 200
        client.get("/healthz")
    spans: Sequence[trace.Span] = exporter.get_finished_spans()
    of_trace = {s.name: s for s in spans if trace.format_trace_id(s.context.trace_id) == TRACE}
    assert {"replan", "strategy", "paths", "planning request"} <= set(of_trace)
    assert of_trace["replan"].attributes["outcome"] == "new plan"
    assert of_trace["replan"].attributes["mission"] == url.rsplit("/", 1)[1]
    assert of_trace["strategy"].parent.span_id == of_trace["replan"].context.span_id
    assert of_trace["strategy"].end_time <= of_trace["paths"].end_time
    assert of_trace["planning request"].attributes["status"] == "finished"
    assert not any("healthz" in span.name for span in spans)


@pytest.mark.asyncio
async def test_the_trace_goes_on_in_the_worker() -> None:
    pool = process_pool(PoolParameters(workers=1))
    assert (await ending(submit(pool, OddWork(traceparent=PARENT))))["trace"] == TRACE
    assert (await ending(submit(pool, OddWork())))["trace"] is None
    await pool.close()


def test_logs_name_the_trace() -> None:
    record = logging.LogRecord("service", logging.INFO, "", 0, "hello %s", ("world",), None)
    assert "trace_id" not in json.loads(JsonLines().format(record))
    with continued(PARENT):
        assert trace_id() == TRACE
        assert (traceparent() or "").startswith(f"00-{TRACE}-")
        line = json.loads(JsonLines().format(record))
    assert (line["message"], line["trace_id"]) == ("hello world", TRACE)
    assert traceparent() is None
