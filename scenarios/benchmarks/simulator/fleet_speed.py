"""Fleets that patrol the hospital floor, on one core, without a planner."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from scenarios.benchmarks.simulator.patrol import Patrol
from scenarios.composition import compose
from scenarios.scenario_file import read_scenario
from simulator.fleet_client import FleetClient
from simulator.simulation import Simulation

_SCENARIO = Path(__file__).parents[2] / "disaster" / "hospital.toml"
_PARTS = {
    "laser": ("", "_sense"),
    "right of way": ("right_of_way", "update"),
    "driving": ("driving", "drive"),
    "physics": ("world", "step"),
    "reports": ("", "_report"),
}


def run(*, quick: bool, out: Path) -> str:
    """Measures teams of several sizes; the target is 24 robots at 20 times real time."""
    teams = [(24, 180)] if quick else [(4, 180), (24, 180), (24, 1080), (100, 180)]
    simulated_s = 20.0 if quick else 120.0
    heads = ["robots", "beams", "times real time", "CPU s", *_PARTS, "rest", "gave way", "touches"]
    rows = [heads, ["---"] * len(heads)]
    for robots, beams in teams:
        rows.append(_measure(robots, beams, simulated_s, out))
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _measure(robots: int, beams: int, simulated_s: float, out: Path) -> list[str]:
    scenario = read_scenario(_SCENARIO).model_copy(
        update={"team": {"explorer": robots}, "blockades": ()}
    )
    fleet = compose(scenario, seed=1, folder=out).fleet
    fleet = replace(
        fleet,
        time_limit_s=simulated_s,
        robot_types=tuple(replace(kind, beams=beams) for kind in fleet.robot_types),
    )
    simulation = Simulation(fleet, FleetClient(Patrol(seed=1)))
    spent = dict.fromkeys(_PARTS, 0.0)
    for part, (owner, method) in _PARTS.items():
        _clock(getattr(simulation, owner) if owner else simulation, method, spent, part)
    begin_s = time.process_time()
    for _ in simulation.run():
        pass
    cpu_s = time.process_time() - begin_s
    if simulation.result is None:
        raise RuntimeError("the simulation ended without a result")
    contacts = simulation.result.contacts
    shares = [f"{100 * spent[part] / cpu_s:.0f} %" for part in _PARTS]
    rest = f"{100 * (1 - sum(spent.values()) / cpu_s):.0f} %"
    return [
        str(robots),
        str(beams),
        f"{simulated_s / cpu_s:.0f}",
        f"{cpu_s:.1f}",
        *shares,
        rest,
        str(simulation.result.give_ways),
        str(contacts.wall + contacts.robot + contacts.blockade),
    ]


def _clock(owner: Any, method: str, spent: dict[str, float], part: str) -> None:
    """Lets a method add the CPU time of its calls to `spent[part]`."""
    original: Callable[..., Any] = getattr(owner, method)

    def clocked(*arguments: Any, **named: Any) -> Any:
        begin_s = time.process_time()
        try:
            return original(*arguments, **named)
        finally:
            spent[part] += time.process_time() - begin_s

    setattr(owner, method, clocked)
