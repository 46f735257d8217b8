"""Runs a server in a process of its own and fleets against it in real time."""

import asyncio
import json
import os
import socket
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import httpx
import numpy as np

from scenarios.benchmarks.service.gliding_fleet import GlidingFleet

PERIOD_S = 0.5
"""Two reports a second."""


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
    lost: int = 0
    """Reports that were answered and that the mission does not know of."""
    memory_mb: list[float] = field(default_factory=list)


@dataclass
class Facts:
    """When the facts of a mission were sent that nothing was heard of yet."""

    since_s: float | None = None


async def listen(client: httpx.AsyncClient, url: str, facts: Facts, measured: Measured) -> None:
    """Hears of decisions as they are made."""
    with suppress(httpx.TransportError):
        async with client.stream("GET", f"{url}/events", timeout=None) as stream:
            async for line in stream.aiter_lines():
                decided = line in ("event: orders-issued", "event: plan-kept")
                if decided and facts.since_s is not None:
                    measured.commands_s.append(time.perf_counter() - facts.since_s)
                    facts.since_s = None


async def fleet(client: httpx.AsyncClient, seed: int, until_s: float, measured: Measured) -> None:
    """One fleet with one mission after another."""
    await asyncio.sleep((seed % 50) * PERIOD_S / 50)
    while time.perf_counter() < until_s:
        team = GlidingFleet(seed)
        seed += 1000
        created = await client.post("/v1/missions", json=team.mission(f"benchmark {seed}"))
        created.raise_for_status()
        url = created.headers["location"]
        measured.missions += 1
        facts = Facts()
        listener = asyncio.create_task(listen(client, url, facts, measured))
        await one_mission(client, url, team, facts=facts, until_s=until_s, measured=measured)
        known = (await client.get(url)).json()["sequence"]
        measured.lost += known != team.sequence - 1
        listener.cancel()
        await asyncio.gather(listener, return_exceptions=True)


async def one_mission(
    client: httpx.AsyncClient,
    url: str,
    team: GlidingFleet,
    *,
    facts: Facts,
    until_s: float,
    measured: Measured,
) -> None:
    """Reports twice a second until the mission is over."""
    due_s = time.perf_counter()
    while time.perf_counter() < until_s:
        body, fact = team.report()
        begun_s = time.perf_counter()
        if fact and facts.since_s is None:
            facts.since_s = begun_s
        answer = await client.post(f"{url}/reports", json=body)
        measured.answers_s.append(time.perf_counter() - begun_s)
        measured.reports += 1
        if answer.status_code != 200:
            measured.refused += 1
            continue
        told = answer.json()
        if told["mission"]["status"] in ("completed", "failed"):
            return
        team.obey(told["commands"])
        team.advance(PERIOD_S)
        due_s += PERIOD_S
        await asyncio.sleep(max(0.0, due_s - time.perf_counter()))


def resident_mb(pid: int) -> float:
    """Memory of a process [MiB]."""
    for line in Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024
    return 0.0


async def watch_memory(pid: int, measured: Measured) -> None:
    """Samples the server's memory."""
    while True:
        measured.memory_mb.append(resident_mb(pid))
        await asyncio.sleep(2.0)


async def load(url: str, pid: int, fleets: int, duration_s: float) -> Measured:
    """All fleets at once."""
    measured = Measured()
    limits = httpx.Limits(max_connections=None, max_keepalive_connections=None)
    async with httpx.AsyncClient(base_url=url, timeout=30.0, limits=limits) as client:
        watcher = asyncio.create_task(watch_memory(pid, measured))
        until_s = time.perf_counter() + duration_s
        await asyncio.gather(*(fleet(client, seed, until_s, measured) for seed in range(fleets)))
        watcher.cancel()
        await asyncio.gather(watcher, return_exceptions=True)
    return measured


def start_server(database: Path) -> tuple[subprocess.Popen[bytes], str]:
    """A server process and its address, once it answers."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "scenarios.cli", "serve"),
            *("--port", str(port), "--db", f"sqlite:///{database}"),
        ],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    url = f"http://127.0.0.1:{port}"
    for _ in range(600):
        with suppress(httpx.TransportError):
            if httpx.get(f"{url}/readyz").status_code == 200:
                return process, url
        time.sleep(0.05)
    raise TimeoutError("the server did not start")


def run(*, quick: bool, out: Path) -> str:
    """50 fleets of 5 robots at 2 Hz for five minutes; 10 fleets for 30 s if quick."""
    fleets, duration_s = (10, 30.0) if quick else (50, 300.0)
    database = out / "missions.sqlite"
    for leftover in out.glob("missions.sqlite*"):
        leftover.unlink()
    process, url = start_server(database)
    try:
        measured = asyncio.run(load(url, process.pid, fleets, duration_s))
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
    """The figures that are asked for."""
    answers = np.array(measured.answers_s) * 1000
    commands = np.array(measured.commands_s) * 1000
    memory = measured.memory_mb
    half = len(memory) // 2
    return {
        "fleets": fleets,
        "duration [s]": duration_s,
        "missions": measured.missions,
        "reports": measured.reports,
        "reports refused": measured.refused,
        "missions with lost reports": measured.lost,
        "report to answer, median [ms]": round(float(np.median(answers)), 1),
        "report to answer, p95 [ms]": round(float(np.percentile(answers, 95)), 1),
        "report to answer, maximum [ms]": round(float(answers.max()), 1),
        "fact to new commands, median [ms]": round(float(np.median(commands)), 1),
        "fact to new commands, p95 [ms]": round(float(np.percentile(commands, 95)), 1),
        "facts": len(commands),
        "server memory at half time [MiB]": round(memory[half], 1),
        "server memory at the end [MiB]": round(memory[-1], 1),
    }
