"""Listens to the traffic between fleet and service, and tells afterwards what happened.

Both sides stay untouched: the recorder sits in the HTTP transport between them.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import httpx

from scenarios.mission_record import Activity, PlannedStep, PlanRecord

Json = dict[str, Any]


@dataclass
class Recorder:
    """What was said so far."""

    mission: Json | None = None
    """the mission as the service returned it when it was created"""
    answer: Json | None = None
    """the latest answer's `mission`"""
    time_s: float = 0.0
    seen_at_s: dict[str, float] = field(default_factory=dict)
    plans: list[PlanRecord] = field(default_factory=list)
    listener: Callable[[Recorder], None] | None = None
    """called after each report, for a progress display"""
    _activities: dict[str, list[Activity]] = field(default_factory=dict)
    _orders: dict[str, tuple[str, str | None]] = field(default_factory=dict)
    """robot: kind and place of what it does since the latest report"""
    _finished: set[str] = field(default_factory=set)
    _revision: int = -1

    def created(self, mission: Json) -> None:
        """The service accepted a mission."""
        self.mission = mission

    def reported(self, report: Json, answer: Json) -> bool:
        """A report and its answer; true if a new plan may be in force."""
        for robot in report.get("robots", []):
            self._continue(robot, float(report["time_s"]))
        self.time_s = float(report["time_s"])
        for blockade in report.get("blockades", []):
            self.seen_at_s.setdefault(blockade["id"], self.time_s)
        self._finished |= {f["command"] for f in report.get("finished", [])}
        self._finished |= {f["command"] for f in report.get("failed", [])}
        carried = {r["id"]: r["state"] for r in report.get("robots", [])}
        orders = {command["robot"]: command for command in answer["commands"]}
        for robot, state in carried.items():
            self._orders[robot] = self._order(state, orders.get(robot))
        self.answer = answer["mission"]
        if self.listener is not None:
            self.listener(self)
        renewed = bool(answer["mission"]["revision"] != self._revision)
        self._revision = answer["mission"]["revision"]
        return renewed

    def planned(self, plan: Json) -> None:
        """A plan that the service says is in force."""
        steps = tuple(
            PlannedStep(
                step["action"],
                tuple(step["arguments"]),
                float(step["start_s"]),
                float(step["duration_s"] or 0.0),
            )
            for step in plan["steps"]
        )
        if self.plans and self.plans[-1].steps == steps:
            return
        self.plans.append(
            PlanRecord(
                revision=int(plan["revision"]),
                time_s=self.time_s,
                makespan_s=float(plan["makespan_s"]),
                validated=bool(plan["validated"]),
                steps=steps,
            )
        )

    def activities(self, robot: str) -> tuple[Activity, ...]:
        """What a robot did, one entry for each stretch of the same kind and place."""
        return tuple(self._activities.get(robot, ()))

    def _order(self, state: str, command: Json | None) -> tuple[str, str | None]:
        if state in ("failed", "docked"):
            return state, None
        if command is None or command["id"] in self._finished:
            return "wait", None
        return command["kind"], command.get("location")

    def _continue(self, robot: Json, time_s: float) -> None:
        """Closes the stretch from the report before to `time_s`."""
        kind, location = self._orders.get(robot["id"], ("wait", None))
        if time_s <= self.time_s:
            return
        stretches = self._activities.setdefault(robot["id"], [])
        begin_s = self.time_s
        if stretches and (stretches[-1].kind, stretches[-1].location) == (kind, location):
            begin_s = stretches.pop().start_s
        stretches.append(Activity(kind, location, begin_s, time_s))


class RecordingTransport(httpx.BaseTransport):
    """Passes everything through, tells the recorder, asks for the plan when it changed."""

    def __init__(self, inner: httpx.BaseTransport, recorder: Recorder) -> None:
        self._inner = inner
        self._recorder = recorder

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """The inner transport's answer."""
        body = request.read()
        answer = self._inner.handle_request(request)
        content = answer.read()
        if request.method == "POST" and answer.status_code < 300:
            path = request.url.path
            if path.endswith("/v1/missions"):
                self._recorder.created(json.loads(content))
            elif path.endswith("/reports") and self._recorder.reported(
                json.loads(body), json.loads(content)
            ):
                self._ask_for_plan(request)
        return answer

    def close(self) -> None:
        """Closes the inner transport."""
        self._inner.close()

    def _ask_for_plan(self, request: httpx.Request) -> None:
        url = request.url.copy_with(path=request.url.path.removesuffix("/reports") + "/plan")
        answer = self._inner.handle_request(httpx.Request("GET", url))
        content = answer.read()
        if answer.status_code == 200:
            self._recorder.planned(json.loads(content))
