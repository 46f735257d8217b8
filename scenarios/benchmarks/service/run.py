"""Runs a server in a process of its own and fleets against it in real time."""

import asyncio
import json
import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.benchmarks.service.connection import Connection, ConnectionLostError
from scenarios.benchmarks.service.gliding_fleet import GlidingFleet
from scenarios.benchmarks.service.processes import cpu_s, family, resident_mb

PERIOD_S = 0.5
"""Two reports a second."""
HOST = "127.0.0.1"
WARM_UP_S = 10.0
"""At the beginning all fleets create a mission at once; figures of the service at work begin then.
"""


@dataclass
class Usage:
    """Processor time and memory of the server, from the end of the warm-up."""

    server_cpu_s: float = 0.0
    """The process that answers."""
    planners_cpu_s: float = 0.0
    """The processes that plan."""
    load_cpu_s: float = 0.0
    """The process that makes the load."""
    duration_s: float = 0.0
    server_mb: list[float] = field(default_factory=list)
    planners_mb: list[float] = field(default_factory=list)


@dataclass
class Measured:
    """What the fleets and their listeners saw."""

    answers_s: list[float] = field(default_factory=list)
    """From report to answer."""
    commands_s: list[float] = field(default_factory=list)
    """From sending a report with a fact to hearing of the decision."""
    reports: int = 0
    refused: int = 0
    missions: int = 0
    completed: int = 0
    lost: int = 0
    """Missions that do not know of a report that was answered."""
    makespans_s: list[float] = field(default_factory=list)
    """Of the missions that were completed."""
    usage: Usage = field(default_factory=Usage)


@dataclass
class Facts:
    """When the facts of a mission were sent that nothing was heard of yet."""

    since_s: float | None = None


@dataclass
class Load:
    """All fleets, and the server they talk to."""

    port: int
    begin_s: float
    until_s: float
    measured: Measured = field(default_factory=Measured)

    def connection(self) -> Connection:
        """A new connection to the server."""
        return Connection(HOST, self.port)

    @property
    def counts(self) -> bool:
        """Whether the warm-up is over."""
        return time.perf_counter() >= self.begin_s

    async def listen(self, url: str, facts: Facts) -> None:
        """Hears of decisions as they are made."""
        async for line in self.connection().lines(f"{url}/events"):
            if line in ("event: orders-issued", "event: plan-kept") and facts.since_s is not None:
                if self.counts:
                    self.measured.commands_s.append(time.perf_counter() - facts.since_s)
                facts.since_s = None

    async def fleet(self, seed: int) -> None:
        """One fleet with one mission after another."""
        await asyncio.sleep((seed % 50) * PERIOD_S / 50)
        connection = self.connection()
        while time.perf_counter() < self.until_s:
            team = GlidingFleet(seed)
            seed += 1000
            body = team.mission(f"benchmark {seed}", f"fleet-{seed % 1000}")
            status, created = await connection.request("POST", "/v1/missions", body)
            if status != 201:
                raise RuntimeError(f"the mission was not accepted: {created}")
            url = f"/v1/missions/{created['id']}"
            self.measured.missions += 1
            facts = Facts()
            listener = asyncio.create_task(self.listen(url, facts))
            await self.mission(connection, url, team, facts)
            _, known = await connection.request("GET", url)
            self.measured.lost += known["sequence"] != team.sequence - 1
            listener.cancel()
            await asyncio.gather(listener, return_exceptions=True)
        connection.close()

    async def mission(
        self, connection: Connection, url: str, team: GlidingFleet, facts: Facts
    ) -> None:
        """Reports twice a second until the mission is over; a report without answer is repeated."""
        due_s = time.perf_counter()
        while time.perf_counter() < self.until_s:
            body, fact = team.report()
            begun_s = time.perf_counter()
            if fact and facts.since_s is None:
                facts.since_s = begun_s
            status, told = await self.delivered(connection, f"{url}/reports", body)
            if self.counts:
                self.measured.answers_s.append(time.perf_counter() - begun_s)
                self.measured.reports += 1
            if status != 200:
                self.measured.refused += 1
                continue
            if told["mission"]["status"] in ("completed", "failed"):
                self.measured.completed += told["mission"]["status"] == "completed"
                self.measured.makespans_s.append(team.time_s)
                return
            team.obey(told["commands"])
            team.advance(PERIOD_S)
            due_s += PERIOD_S
            await asyncio.sleep(max(0.0, due_s - time.perf_counter()))

    async def delivered(
        self, connection: Connection, path: str, body: dict[str, Any]
    ) -> tuple[int, Any]:
        """The answer to a report, sent until there is one."""
        while True:
            try:
                return await connection.request("POST", path, body)
            except ConnectionLostError:
                await asyncio.sleep(0.1)

    async def watch(self, pid: int) -> None:
        """Samples the server's memory; counts processor time from the end of the warm-up."""
        await asyncio.sleep(max(0.0, self.begin_s - time.perf_counter()))
        usage = self.measured.usage
        begun = cpu_s(pid), sum(cpu_s(one) for one in family(pid)[1:]), time.process_time()
        begun_s = time.perf_counter()
        while True:
            planners = family(pid)[1:]
            usage.server_mb.append(resident_mb(pid))
            usage.planners_mb.append(sum(resident_mb(one) for one in planners))
            usage.server_cpu_s = cpu_s(pid) - begun[0]
            usage.planners_cpu_s = sum(cpu_s(one) for one in planners) - begun[1]
            usage.load_cpu_s = time.process_time() - begun[2]
            usage.duration_s = time.perf_counter() - begun_s
            await asyncio.sleep(2.0)


async def load(port: int, pid: int, fleets: int, duration_s: float) -> Measured:
    """All fleets at once."""
    now_s = time.perf_counter()
    everything = Load(port, now_s + WARM_UP_S, now_s + WARM_UP_S + duration_s)
    watcher = asyncio.create_task(everything.watch(pid))
    await asyncio.gather(*(everything.fleet(seed) for seed in range(fleets)))
    watcher.cancel()
    await asyncio.gather(watcher, return_exceptions=True)
    return everything.measured


def start_server(database: Path, *options: str) -> tuple[subprocess.Popen[bytes], int]:
    """A server process and its port, once it answers."""
    with socket.socket() as free:
        free.bind((HOST, 0))
        port = free.getsockname()[1]
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "scenarios.cli", "serve"),
            *("--port", str(port), "--db", f"sqlite:///{database}", *options),
        ],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    for _ in range(1200):
        try:
            with urllib.request.urlopen(f"http://{HOST}:{port}/readyz") as answer:
                if answer.status == 200:
                    return process, port
        except (urllib.error.URLError, ConnectionError):
            time.sleep(0.05)
    raise TimeoutError("the server did not start")


def run(*, quick: bool, out: Path) -> str:
    """50 fleets of 5 robots at 2 Hz for five minutes; 10 fleets for 20 s if quick."""
    return measure(out, *((10, 20.0) if quick else (50, 300.0)))


def measure(out: Path, fleets: int, duration_s: float) -> str:
    """A table of what so many fleets see in that time."""
    out.mkdir(parents=True, exist_ok=True)
    for leftover in out.glob("missions.sqlite*"):
        leftover.unlink()
    process, port = start_server(out / "missions.sqlite")
    try:
        measured = asyncio.run(load(port, process.pid, fleets, duration_s))
    finally:
        process.terminate()
        process.wait(30)
    result = summary(measured, fleets, duration_s)
    (out / "results.json").write_text(json.dumps(result, indent=2), encoding="utf-8")
    rows = "\n".join(f"| {name} | {value:g} |" for name, value in result.items())
    return (
        f"# Service under load ({os.cpu_count()} cores)\n\n| measure | value |\n|---|---|\n{rows}\n"
    )


def summary(measured: Measured, fleets: int, duration_s: float) -> dict[str, float]:
    """The figures that are asked for, and what they depend on."""
    answers = np.array(measured.answers_s) * 1000
    commands = np.array(measured.commands_s) * 1000
    usage = measured.usage
    half = len(usage.server_mb) // 2
    return {
        "fleets": fleets,
        "duration [s]": duration_s,
        "missions": measured.missions,
        "missions completed": measured.completed,
        "median makespan of completed missions [s]": float(np.median(measured.makespans_s or [0])),
        "reports": measured.reports,
        "reports refused": measured.refused,
        "missions with lost reports": measured.lost,
        "report to answer, median [ms]": round(float(np.median(answers)), 1),
        "report to answer, p95 [ms]": round(float(np.percentile(answers, 95)), 1),
        "report to answer, maximum [ms]": round(float(answers.max()), 1),
        "fact to new commands, median [ms]": round(float(np.median(commands)), 1),
        "fact to new commands, p95 [ms]": round(float(np.percentile(commands, 95)), 1),
        "facts": len(commands),
        "server processor time for each report [ms]": round(
            1000 * usage.server_cpu_s / measured.reports, 2
        ),
        "planners' processor time for each decision [ms]": round(
            1000 * usage.planners_cpu_s / max(len(commands), 1), 1
        ),
        "server's share of a core": round(usage.server_cpu_s / usage.duration_s, 3),
        "planners' share of a core": round(usage.planners_cpu_s / usage.duration_s, 3),
        "load generator's share of a core": round(usage.load_cpu_s / usage.duration_s, 3),
        "load average of the machine": round(os.getloadavg()[0], 2),
        "server memory at half time [MiB]": round(usage.server_mb[half], 1),
        "server memory at the end [MiB]": round(usage.server_mb[-1], 1),
        "planners' memory at half time [MiB]": round(usage.planners_mb[half], 1),
        "planners' memory at the end [MiB]": round(usage.planners_mb[-1], 1),
    }
