"""A real server is killed, asked to stop, and listened to by clients that have gone.

No accepted mission is lost, none is stuck, no command is executed twice.
"""

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from http.client import HTTPException
from pathlib import Path

import pytest
from scripted_fleet import ScriptedFleet
from server_process import ServerProcess
from test_mission_loop import ROOMS, TARGETS, fleet

WAIT = {"Prefer": "wait=10"}


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ServerProcess]:
    started = ServerProcess(tmp_path)
    started.start()
    yield started
    if started.process is not None and started.process.poll() is None:
        started.kill()


def create(server: ServerProcess, team: ScriptedFleet, strategy: str = "planner") -> str:
    status, mission = server.request(
        "POST", "/v1/missions", team.mission(ROOMS, TARGETS, strategy=strategy)
    )
    assert status == 201
    return f"/v1/missions/{mission['id']}"


def deeds(team: ScriptedFleet) -> list[tuple[str, str | None]]:
    return [(kind, place) for _, kind, place in team.executed if kind in ("explore", "clear")]


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_missions_go_on_after_the_server_was_killed(server: ServerProcess) -> None:
    """Killed at any moment: before a report, after one, and while one is under way."""
    teams = [fleet(), fleet()]
    urls = [create(server, teams[0]), create(server, teams[1], "hungarian")]
    over: set[int] = set()
    for step in range(400):
        for number, (team, url) in enumerate(zip(teams, urls, strict=True)):
            if number in over:
                continue
            report = team.report()
            if (step, number) in ((2, 0), (9, 1)):
                workers = server.children()
                server.kill()
                wait_until_gone(workers)
                server.start()
            if (step, number) == (5, 0):
                unanswered(server, url, report)
                server.start()
            status, answer = server.request("POST", f"{url}/reports", report, **WAIT)
            assert status == 200, answer
            assert answer["mission"]["sequence"] == report["sequence"]
            if answer["mission"]["status"] == "completed":
                over.add(number)
                continue
            team.obey(answer)
            team.step()
        if len(over) == len(teams):
            break
    for team, url in zip(teams, urls, strict=True):
        mission = server.request("GET", url)[1]
        assert mission["status"] == "completed"
        endings = [d for d in mission["decisions"] if d["kind"] in ("completed", "failed")]
        assert len(endings) == 1
        assert len(deeds(team)) == len(set(deeds(team)))


def unanswered(server: ServerProcess, url: str, report: object) -> None:
    """The server dies at some moment while it deals with a report."""
    assert server.process is not None
    killer = threading.Timer(0.004, server.process.kill)
    killer.start()
    with suppress(OSError, HTTPException):
        server.request("POST", f"{url}/reports", report)
    killer.join()
    server.process.wait(30)


def wait_until_gone(pids: list[int]) -> None:
    """No planner outlives its server."""
    deadline_s = time.monotonic() + 10.0
    while any(is_running(pid) for pid in pids):
        assert time.monotonic() < deadline_s
        time.sleep(0.02)


def is_running(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_asked_to_stop_it_ends_streams_and_is_gone_soon(server: ServerProcess) -> None:
    team = fleet()
    url = create(server, team)
    assert server.request("POST", f"{url}/reports", team.report(), **WAIT)[0] == 200
    stream = server.listen(f"{url}/events")
    heard = stream.recv(65536)
    while b"orders-issued" not in heard:
        heard += stream.recv(65536)
    idle = server.children()
    assert server.kill(signal.SIGTERM) < 5.0
    assert stream.recv(65536) in (b"", b"0\r\n\r\n")
    stream.close()
    wait_until_gone(idle)
    server.start()
    missed = server.listen(f"{url}/events", **{"Last-Event-ID": "0"})
    heard = missed.recv(65536)
    while b"report-accepted" not in heard:
        heard += missed.recv(65536)
    missed.close()


@pytest.mark.slow
def test_listeners_that_have_gone_without_a_word_cost_nobody_anything(
    server: ServerProcess,
) -> None:
    """Half-open connections: nobody reads, nobody closes."""
    team = fleet()
    url = create(server, team, "hungarian")
    gone = [server.listen(f"{url}/events") for _ in range(30)]
    before_mb = server.resident_mb
    slowest_s = 0.0
    padding = {"robots": [], "blockades": []}
    first = team.report()
    assert server.request("POST", f"{url}/reports", first)[0] == 200
    for sequence in range(1, 400):
        body = {**padding, "sequence": sequence, "time_s": 0.1 * sequence}
        body["robots"] = first["robots"]
        begun_s = time.monotonic()
        assert server.request("POST", f"{url}/reports", body)[0] == 200
        slowest_s = max(slowest_s, time.monotonic() - begun_s)
    assert server.resident_mb < before_mb + 60.0
    assert server.kill(signal.SIGTERM) < 20.0
    for connection in gone:
        connection.close()


@pytest.mark.slow
def test_a_killed_worker_costs_a_request_not_a_mission(server: ServerProcess) -> None:
    team = fleet()
    url = create(server, team)
    for step in range(400):
        if step % 7 == 3:
            kill_workers(server)
        status, answer = server.request("POST", f"{url}/reports", team.report(), **WAIT)
        assert status == 200
        if answer["mission"]["status"] == "completed":
            break
        team.obey(answer)
        team.step()
    assert server.request("GET", url)[1]["status"] == "completed"
    assert len(deeds(team)) == len(set(deeds(team)))


def kill_workers(server: ServerProcess) -> None:
    """Those that lead a process group of their own."""
    for pid in server.children():
        try:
            if os.getpgid(pid) == pid:
                os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            continue
