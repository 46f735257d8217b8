"""A server killed with -9 in the middle of a mission, again and again: the mission goes on."""

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

sys.path.insert(0, str(Path(__file__).parents[1] / "service"))
from scripted_fleet import HiddenBlockade, Robot, ScriptedFleet, walls

ROOT = Path(__file__).parents[2]
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
    mission = team.mission(ROOMS, [(2.5, 6.5), (17.5, 6.5), (17.5, 1.5)], strategy=strategy)
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
    deeds = [(kind, place) for _, kind, place in team.executed if kind in ("explore", "clear")]
    assert len(deeds) == len(set(deeds))
    started_again = [d for d in detail["decisions"] if "started again" in d["reason"]]
    assert len(started_again) == len(kill_at)
