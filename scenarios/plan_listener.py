"""Collects every plan that comes into force, from the traffic between fleet and service.

Both sides stay untouched: the listener sits in the HTTP transport between them.
"""

from __future__ import annotations

import json
from typing import Any

import httpx

from scenarios.mission_record import PlannedStep, PlanRecord

REPORTS = "/reports"


class PlanListener(httpx.BaseTransport):
    """Passes everything through; asks for the plan whenever an answer carries a new revision."""

    def __init__(self, inner: httpx.BaseTransport) -> None:
        self.plans: list[PlanRecord] = []
        self._inner = inner
        self._revision = -1

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """The inner transport's answer."""
        body = request.read()
        answer = self._inner.handle_request(request)
        content = answer.read()
        path = request.url.path
        if request.method == "POST" and path.endswith(REPORTS) and answer.status_code == 200:
            revision = int(json.loads(content)["mission"]["revision"])
            if revision != self._revision:
                self._revision = revision
                self._ask(request, float(json.loads(body)["time_s"]))
        return answer

    def close(self) -> None:
        """Closes the inner transport."""
        self._inner.close()

    def _ask(self, request: httpx.Request, time_s: float) -> None:
        url = request.url.copy_with(path=request.url.path.removesuffix(REPORTS) + "/plan")
        headers = {k: v for k, v in request.headers.items() if k in ("authorization", "host")}
        answer = self._inner.handle_request(httpx.Request("GET", url, headers=headers))
        content = answer.read()
        if answer.status_code == 200:
            plan = _read(json.loads(content), time_s)
            if not self.plans or self.plans[-1].steps != plan.steps:
                self.plans.append(plan)


def _read(plan: dict[str, Any], time_s: float) -> PlanRecord:
    steps = tuple(
        PlannedStep(
            step["action"],
            tuple(step["arguments"]),
            float(step["start_s"]),
            float(step["duration_s"] or 0.0),
        )
        for step in plan["steps"]
    )
    return PlanRecord(
        revision=int(plan["revision"]),
        time_s=time_s,
        makespan_s=float(plan["makespan_s"]),
        validated=bool(plan["validated"]),
        steps=steps,
    )
