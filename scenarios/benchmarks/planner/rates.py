"""Expansions of the decision-epoch search per CPU second, heuristic included.

The recorded rates of TFD/M are from the same instances, by size. A second table plans the same
generated problems twice: with path costs as attachments of PDDL/M, and compiled into numeric
fluents.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from planner import Problem, read_domain, read_problem
from planner.attachments import Attachments
from planner.compile_attachments import compile_attachments
from planner.solving import Limits, Space, improving_plans
from scenarios.benchmarks._markdown import table

DOMAIN = Path("domains/disaster/domain.pddl")
SETUP_NODES = 100
"""Expansions of a first run, whose time is taken off: reading, grounding, tables."""
SIDE_M = 100.0
"""Of the square on which generated places lie [m]."""
FEWEST = 2_000
"""Expansions below which a space is too small for a rate."""


@dataclass(frozen=True, slots=True)
class Size:
    """A generated disaster problem."""

    title: str
    explorers: int
    clearers: int
    targets: int
    blockades: int


SIZES = (Size("hospital", 3, 2, 15, 18), Size("power plant", 3, 2, 13, 58))
TFD_RATES = {
    "disaster": "2,100-3,500",
    "d07-3x2-t15-b18": "1,100",
    "marsupial": "2,300-4,400",
    "hospital": "1,100",
    "power plant": "246",
}
"""Expansions per CPU second that TFD/M was measured to reach, by family, instance or size."""


def run(folder: Path, *, quick: bool) -> str:
    """Both tables; the first one is left out where `folder` is absent."""
    nodes = 20_000 if quick else 100_000
    rows = []
    for family in ("disaster", "marsupial"):
        domain = folder / family / "domain.pddl"
        for path in sorted((folder / family).glob("?[0-9]*.pddl")):
            rate = expansion_rate(read_problem(read_domain(domain), path), None, nodes)
            peer = TFD_RATES.get(path.stem, TFD_RATES[family])
            rows.append([path.stem, _shown(rate), peer])
    parts = []
    if rows:
        columns = ["instance", "expansions per CPU second", "TFD/M"]
        parts.append(table("Rate of the decision-epoch search", columns, rows))
    rows = []
    for size in SIZES:
        problem, attachments = generated(size, seed=1)
        with_modules = expansion_rate(problem, attachments, nodes)
        plain = compile_attachments(problem, attachments).read()
        with_fluents = expansion_rate(plain, None, nodes)
        ratio = "-"
        if with_modules is not None and with_fluents is not None:
            ratio = f"{with_modules / with_fluents:.2f}"
        cells = [size.title, _shown(with_modules), _shown(with_fluents), ratio]
        rows.append([*cells, TFD_RATES[size.title]])
    columns = ["size", "cost modules", "numeric fluents", "ratio", "TFD/M"]
    parts.append(table("The same with cost modules and with numeric fluents", columns, rows))
    return "\n\n".join(parts)


def expansion_rate(problem: Problem, attachments: Attachments | None, nodes: int) -> float | None:
    """Expansions per CPU second [1/s]; None if the space is exhausted too early to tell."""
    few, setup_s = _search(problem, attachments, SETUP_NODES)
    many, spent_s = _search(problem, attachments, nodes)
    if many - few < FEWEST:
        return None
    return (many - few) / (spent_s - setup_s)


def _search(problem: Problem, attachments: Attachments | None, nodes: int) -> tuple[int, float]:
    """Expansions and the CPU time they took [s]."""
    limits = Limits(timeout_s=None, node_limit=nodes, space=Space.DECISION_EPOCHS)
    begun_s = time.process_time()
    search = improving_plans(problem, attachments, limits)
    while True:
        try:
            next(search)
        except StopIteration as end:
            return end.value.statistics.expansions, time.process_time() - begun_s


class _Distances:
    """Travel times at 1 m/s; some targets lie behind a blockade."""

    def __init__(self, place_m: dict[str, tuple[float, float]], behind: dict[str, str]) -> None:
        self._place_m = place_m
        self._behind = behind

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        """Travel times [s], infinite where a blockade is in between."""
        return [self._one(start, goal) for _, start, goal in calls]

    def _one(self, start: str, goal: str) -> float:
        for one, other in ((start, goal), (goal, start)):
            if self._behind.get(one, other) != other:
                return math.inf
        return 1.0 + math.dist(self._place_m[start], self._place_m[goal])


def generated(size: Size, seed: int) -> tuple[Problem, Attachments]:
    """A disaster problem on a square, every third target behind a blockade of its own."""
    source = random.Random(seed)
    named = {
        "explorer": [f"e{index}" for index in range(size.explorers)],
        "clearer": [f"c{index}" for index in range(size.clearers)],
        "mission_target": [f"t{index}" for index in range(size.targets)],
        "blockade": [f"b{index}" for index in range(size.blockades)],
    }
    robots = named["explorer"] + named["clearer"]
    named["free_location"] = [f"start-{robot}" for robot in robots]
    places = named["free_location"] + named["mission_target"] + named["blockade"]
    place_m = {place: (source.uniform(0, SIDE_M), source.uniform(0, SIDE_M)) for place in places}
    behind = dict(zip(named["mission_target"][::3], named["blockade"], strict=False))
    objects = " ".join(f"{' '.join(names)} - {kind}" for kind, names in named.items())
    init = " ".join(f"(at {robot} start-{robot})" for robot in robots)
    goal = " ".join(f"(explored {target})" for target in named["mission_target"])
    text = (
        f"(define (problem {size.title.replace(' ', '-')}) (:domain disaster)\n"
        f" (:objects {objects})\n (:init {init})\n (:goal (and {goal})))\n"
    )
    attachments: Attachments = {
        "pathCost": _Distances(place_m, behind),
        "clearCost": lambda *_: 30.0,
    }
    return read_problem(read_domain(DOMAIN), text), attachments


def _shown(rate: float | None) -> str:
    return "-" if rate is None else f"{rate:,.0f}"
