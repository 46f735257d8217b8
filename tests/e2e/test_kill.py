"""A server killed with -9 in the middle of a mission, again and again: the mission goes on.

Once with a scripted fleet, which counts what it was told to do, and once with simulated robots in a
scenario of the command line.
"""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from scenarios.mission import RunOptions, composed, run
from scenarios.mission_record import MissionRecord
from service.coordination.events import Event, OrdersIssued, ReportAccepted
from service.settings import sqlite_url
from service.store.engine import connect
from service.store.event_store import EventStore
from simulator.simulation import Progress

sys.path.insert(0, str(Path(__file__).parents[1] / "service"))
from scripted_fleet import HiddenBlockade, Robot, ScriptedFleet, walls

ROOT = Path(__file__).parents[2]
HOSPITAL = ROOT / "scenarios" / "disaster" / "hospital.toml"
ROOMS = walls(
    [
        "####################",
        "#........#.........#",
        "#........#.........#",
        "#..................#",
        "#........#.........#",
        "####.#########.#####",
        "#..................#",
        "#..................#",
        "####################",
    ]
)


class Server:
    """`marsupial serve` as a process that can be killed and started again."""

    def __init__(self, database: Path) -> None:
        self.database = database
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> None:
        code = "from scenarios.cli import main; main()"
        arguments = ["serve", "--port", str(self.port), "--db", f"sqlite:///{self.database}"]
        self.process = subprocess.Popen(
            [sys.executable, "-c", code, *arguments],
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def kill_and_start(self) -> None:
        self.kill()
        self.start()

    def kill(self) -> None:
        assert self.process is not None
        os.kill(self.process.pid, signal.SIGKILL)
        self.process.wait(10)


@contextmanager
def server(database: Path) -> Iterator[Server]:
    started = Server(database)
    started.start()
    try:
        yield started
    finally:
        if started.process is not None and started.process.poll() is None:
            started.kill()


def insist(url: str, method: str, **more: Any) -> httpx.Response:
    """The answer, however often the server has to be asked: what a fleet client does."""
    patience = time.monotonic() + 30.0
    while True:
        try:
            answer = httpx.request(method, url, timeout=10.0, **more)
        except httpx.TransportError:
            if time.monotonic() > patience:
                raise
            time.sleep(0.05)
        else:
            return answer


@pytest.mark.parametrize("strategy", [pytest.param("hungarian", marks=pytest.mark.slow), "planner"])
def test_a_mission_survives_kill_9(tmp_path: Path, strategy: str) -> None:
    team = ScriptedFleet(
        [Robot("explorer_1", "explorer", (2.5, 2.5)), Robot("clearer_1", "clearer", (4.5, 1.5))],
        [
            HiddenBlockade("blockade_1", ((4.0, 3.5), (5.0, 3.5))),
            HiddenBlockade("blockade_2", ((14.0, 3.5), (15.0, 3.5))),
        ],
    )
    mission = team.mission(
        ROOMS,
        [(2.5, 6.5), (17.5, 6.5), (17.5, 1.5)],
        strategy=strategy,
        planning={"time_limit_s": 0.1},
    )
    acknowledged = -1
    kill_at = {4, 13}
    with server(tmp_path / "missions.sqlite") as running:
        created = insist(f"{running.url}/v1/missions", "POST", json=mission)
        assert created.status_code == 201, created.text
        url = running.url + created.headers["location"]
        for step in range(400):
            if step in kill_at:
                # In the middle of a request, as far as a thread can arrange it.
                killer = threading.Timer(0.002 * step, running.kill_and_start)
                killer.start()
            report = team.report()
            answer = insist(f"{url}/reports", "POST", json=report, headers={"Prefer": "wait=5"})
            if step in kill_at:
                killer.join()
                answer = insist(f"{url}/reports", "POST", json=report, headers={"Prefer": "wait=5"})
            assert answer.status_code == 200, answer.text
            body = answer.json()
            assert body["mission"]["sequence"] >= acknowledged, "an acknowledged report is gone"
            acknowledged = body["mission"]["sequence"]
            if body["mission"]["status"] == "completed":
                break
            team.obey(body)
            team.step()
        detail = insist(url, "GET").json()
    assert detail["status"] == "completed"
    assert all(target["visited_by"] == "explorer_1" for target in detail["targets"])
    deeds = [(robot, kind, place) for robot, kind, place in team.executed if kind != "wait"]
    assert len(deeds) == len(set(deeds))
    started_again = [d for d in detail["decisions"] if "started again" in d["reason"]]
    assert len(started_again) == len(kill_at)


class Fleet:
    """A simulated fleet that knows the service's address and nothing else, in a thread."""

    def __init__(self, scenario: Path, service: str, scratch: Path) -> None:
        self.record: MissionRecord | None = None
        self.time_s = 0.0
        self._under_way = threading.Event()
        self._scenario, self._scratch = scenario, scratch
        self._options = RunOptions(seed=1, service=service, headless=True)
        self._thread = threading.Thread(target=self._run, name="fleet", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            composition = composed(self._scenario, self._options, self._scratch)
            self.record = run(composition, self._options, self._listen)
        finally:
            self._under_way.set()

    def _listen(self, progress: Progress) -> None:
        self.time_s = progress.time_s
        if 0 < progress.targets_left < progress.targets and progress.blockades_known > 0:
            self._under_way.set()

    def wait_until_under_way(self) -> None:
        """Returns when there are targets visited and to visit, and a blockade is known."""
        assert self._under_way.wait(120.0)
        assert self._thread.is_alive(), "the mission was over before the server could be killed"

    def join(self, timeout_s: float) -> MissionRecord:
        """The mission's record when it has ended."""
        self._thread.join(timeout_s)
        assert self.record is not None, f"the mission does not end ({self.time_s:.0f} s)"
        return self.record


def logged(database: Path) -> list[Event]:
    """All events of the one mission in a database."""
    store = EventStore(connect(sqlite_url(database)))
    try:
        (mission_id,) = store.listed(10)
        return list(store.events(mission_id))
    finally:
        store.close()


def assert_nothing_twice(events: list[Event]) -> None:
    """No command is closed twice, none carried out anew, and no id names two orders."""
    orders: dict[str, tuple[str, str, str | None]] = {}
    for event in events:
        for command in event.commands if isinstance(event, OrdersIssued) else ():
            order = (command.robot, command.kind, command.location)
            assert orders.setdefault(command.id, order) == order
    reports = [event.report for event in events if isinstance(event, ReportAccepted)]
    finished = [done.command for report in reports for done in report.finished]
    closed = finished + [failed.command for report in reports for failed in report.failed]
    assert len(closed) == len(set(closed))
    deeds = [orders[command][1:] for command in finished]
    deeds = [deed for deed in deeds if deed[0] in ("explore", "clear")]
    assert len(deeds) == len(set(deeds))
    sequences = [report.sequence for report in reports]
    assert sequences == list(range(len(sequences)))


def survives_kill_9(scenario: Path, folder: Path, kills: int, timeout_s: float) -> MissionRecord:
    """Runs a scenario, kills its server when the mission is under way, starts it again."""
    database = folder / "missions.sqlite"
    with server(database) as running:
        insist(f"{running.url}/healthz", "GET")
        fleet = Fleet(scenario, running.url, folder)
        fleet.wait_until_under_way()
        for _ in range(kills):
            running.kill_and_start()
            insist(f"{running.url}/healthz", "GET")
            time.sleep(0.3)
        record = fleet.join(timeout_s)
        (mission,) = insist(f"{running.url}/v1/missions", "GET").json()
        detail = insist(f"{running.url}/v1/missions/{mission['id']}", "GET").json()
    assert record.completed, record.status_reason
    assert detail["status"] == "completed"
    assert all(target["visited_by"] for target in detail["targets"])
    assert {t["id"] for t in detail["targets"]} == {t.id for t in record.targets}
    assert record.wall_collisions == record.robot_collisions == record.blockade_crossings == 0
    restarts = [d for d in detail["decisions"] if "the service was started again" in d["reason"]]
    assert len(restarts) >= 1
    assert_nothing_twice(logged(database))
    return record


def test_simulated_robots_finish_their_mission_after_kill_9(tmp_path: Path, ward: Path) -> None:
    record = survives_kill_9(ward, tmp_path, kills=1, timeout_s=120.0)
    assert [blockade.cleared_by for blockade in record.blockades] == ["clearer_1"]


@pytest.mark.slow
def test_the_demo_mission_survives_kill_9(tmp_path: Path) -> None:
    record = survives_kill_9(HOSPITAL, tmp_path, kills=3, timeout_s=600.0)
    assert len(record.targets) == 15
