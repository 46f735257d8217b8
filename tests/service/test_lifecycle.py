"""A mission's lifecycle as a state machine: whatever comes in whatever order, the promises hold.

Exactly one terminal state, from which nothing leads away; sequence and revision never go back; one
command a robot, to nobody who takes no part; what the log adds up to is what the service shows,
also after the service was started again.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from in_process import InProcessClient, serving
from scripted_fleet import HiddenBlockade, Robot, ScriptedFleet, walls
from test_mission_map import patch

from service.app import create_app
from service.coordination.history import rebuilt
from service.settings import Settings, sqlite_url

HALL = walls(["#" * 16, *["#" + "." * 14 + "#"] * 5, "#" * 16])
OVER = ("completed", "failed", "canceled")
WAIT = {"Prefer": "wait=20"}
ROBOTS = ["e1", "e2", "c1"]
TARGETS = ["target_1", "target_2", "target_3", "more"]


class Lifecycle(RuleBasedStateMachine):
    """One mission, its fleet, and people who interfere."""

    def __init__(self) -> None:
        super().__init__()
        self.folder = TemporaryDirectory()
        self.settings = Settings(
            database_url=sqlite_url(Path(self.folder.name) / "x.sqlite"),
            planning_workers=1,
            hopeless_s=30.0,
        )
        self.begin()
        self.fleet = ScriptedFleet(
            [
                Robot("e1", "explorer", (2.5, 2.5)),
                Robot("e2", "explorer", (12.5, 4.5)),
                Robot("c1", "clearer", (7.5, 4.5)),
            ],
            [HiddenBlockade("b", ((8.5, 1.0), (8.5, 3.0)), clear_duration_s=4.0)],
        )
        body = self.fleet.mission(
            HALL, [(13.5, 1.5), (1.5, 4.5), (9.5, 5.5)], strategy="hungarian", lease_s=8.0
        )
        self.url = self.client.post("/v1/missions", json=body).headers["location"]
        self.terminal: str | None = None
        self.last = self.client.get(self.url).json()
        self.instructions: list[str] = []

    def begin(self) -> None:
        self.context = serving(create_app(self.settings))
        self.client: InProcessClient = self.context.__enter__()

    def end(self) -> None:
        self.context.__exit__(None, None, None)

    def teardown(self) -> None:
        mission_id = self.url.rsplit("/", 1)[1]
        events = list(self.client.app.state.store.events(mission_id))
        self.end()
        self.folder.cleanup()
        kinds = [event.kind for event in events]
        assert kinds.count("mission-created") == 1
        assert kinds.count("mission-closed") == (1 if self.terminal else 0)
        if self.terminal:
            assert kinds[-1] == "mission-closed"
        assert rebuilt(events).status == self.last["status"]

    def ask(self, method: str, path: str, **more: Any) -> int:
        answer = self.client.request(method, f"{self.url}{path}", headers=WAIT, **more)
        assert answer.status_code < 500, answer.text
        if self.terminal is not None and method in ("POST", "DELETE") and path != "/reports":
            assert answer.status_code in (404, 409, 422) or (path, self.terminal) == (
                "",
                "canceled",
            )
        return answer.status_code

    @rule(steps=st.integers(1, 6), lost=st.sampled_from([None, None, *ROBOTS]))
    def drive(self, steps: int, lost: str | None) -> None:
        """The fleet drives on and reports, perhaps without one of its robots."""
        for _ in range(steps):
            self.fleet.step()
            report = self.fleet.report()
            left = {r["id"] for r in self.last["robots"] if r["left"]}
            report["robots"] = [r for r in report["robots"] if r["id"] not in {lost, *left}]
            answer = self.client.post(f"{self.url}/reports", json=report, headers=WAIT)
            assert answer.status_code == 200, answer.text
            self.check(answer.json())
            self.fleet.obey(answer.json())

    def check(self, answer: dict[str, Any]) -> None:
        """One command a robot; none once the mission is over."""
        robots = [command["robot"] for command in answer["commands"]]
        assert len(robots) == len(set(robots))
        if answer["mission"]["status"] in OVER:
            assert robots == []

    @rule(status=st.sampled_from(["failed", "idle"]), robot=st.sampled_from([0, 1, 2]))
    def fail_or_mend(self, status: str, robot: int) -> None:
        """A robot breaks down, or works again."""
        one = self.fleet.robots[robot]
        if not one.is_busy:
            one.state, one.path, one.command = status, [], None

    @rule(robot=st.sampled_from(ROBOTS))
    def leave(self, robot: str) -> None:
        self.ask("DELETE", f"/robots/{robot}")

    @rule(robot=st.sampled_from(ROBOTS))
    def join(self, robot: str) -> None:
        one = next(r for r in self.fleet.robots if r.id == robot)
        body = {"id": robot, "type": one.type, "pose": [*one.position, 0.0]}
        self.ask("POST", "/robots", json=body)

    @rule(place=st.sampled_from(TARGETS))
    def remove(self, place: str) -> None:
        self.ask("DELETE", f"/targets/{place}")

    @rule()
    def add(self) -> None:
        self.ask("POST", "/targets", json={"id": "more", "position_m": [4.5, 1.5]})

    @rule(
        body=st.one_of(
            st.builds(
                lambda kind, robot, place: {"kind": kind, "robot": robot, "location": place},
                st.sampled_from(["pin", "forbid"]),
                st.sampled_from(ROBOTS),
                st.sampled_from([*TARGETS, "b"]),
            ),
            st.builds(
                lambda target, p: {"kind": "priority", "target": target, "priority": p},
                st.sampled_from(TARGETS),
                st.integers(1, 3),
            ),
            st.builds(
                lambda target, s: {"kind": "deadline", "target": target, "time_s": s},
                st.sampled_from(TARGETS),
                st.floats(0.0, 60.0),
            ),
            st.builds(lambda robot: {"kind": "take-over", "robot": robot}, st.sampled_from(ROBOTS)),
        )
    )
    def instruct(self, body: dict[str, Any]) -> None:
        self.ask("POST", "/instructions", json=body)

    @rule(index=st.integers(0, 5))
    def withdraw(self, index: int) -> None:
        given = self.last["instructions"]
        self.ask("DELETE", f"/instructions/{given[index % len(given)]['id'] if given else 'none'}")

    @rule(shut=st.booleans())
    def sense(self, shut: bool) -> None:
        """A door in the middle turns out to be shut, or open again."""
        wall = patch(1, 6, [[100 if shut else 0]] * 3)
        report = {**self.fleet.report(), "map_patches": [wall]}
        left = {r["id"] for r in self.last["robots"] if r["left"]}
        report["robots"] = [r for r in report["robots"] if r["id"] not in left]
        assert self.ask("POST", "/reports", json=report) == 200

    @rule()
    @precondition(lambda self: self.last["sequence"] > 12)
    def cancel(self) -> None:
        self.ask("DELETE", "")

    @rule()
    def restart(self) -> None:
        """The service is stopped and started with the same database."""
        before = self.client.get(self.url).json()
        self.end()
        self.begin()
        after = self.client.get(self.url).json()
        for name in ("sequence", "targets", "instructions", "blockades", "time_s"):
            assert after[name] == before[name]

    @invariant()
    def promises(self) -> None:
        """What holds after every step."""
        mission = self.client.get(self.url).json()
        assert mission["sequence"] >= self.last["sequence"]
        assert mission["revision"] >= self.last["revision"]
        assert mission["time_s"] >= self.last["time_s"]
        if self.terminal is not None:
            assert mission == self.last
        elif mission["status"] in OVER:
            self.terminal = mission["status"]
        for before, after in zip(self.last["targets"], mission["targets"], strict=False):
            # Visited once and for all.
            assert before["visited_by"] in (None, after["visited_by"])
        for robot in mission["robots"]:
            if robot["lost"] or robot["left"] or robot["taken_over"] or robot["state"] == "failed":
                assert robot["command"] is None
        if mission["status"] == "completed":
            assert mission["targets_left"] == 0
        self.last = mission


TestLifecycle = Lifecycle.TestCase
TestLifecycle.settings = settings(
    max_examples=12,
    stateful_step_count=25,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
pytestmark = pytest.mark.slow
