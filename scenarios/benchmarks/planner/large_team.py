"""A hundred robots: first plan and makespan beside a schedule by the Hungarian method.

Sixty explorers, forty clearers, 300 targets and 100 blockades lie at random on a square of a
kilometre; a way is the distance, at 1 m/s for explorers and 2 m/s for clearers. Every tenth target
is walled off behind a blockade.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from domains import catalogue
from planner import Problem, read_domain, read_problem, solve
from planner.attachments import Attachments
from scenarios.benchmarks._markdown import table
from scenarios.benchmarks.planner.hungarian_schedule import Mission, hungarian_makespan_s

SIDE_M = 1_000.0
CLEAR_S = 100.0
SPEED_M_S = {"e": 1.0, "c": 2.0}


@dataclass(frozen=True)
class Field:
    """Robots, targets and blockades on a square."""

    explorers: int
    clearers: int
    targets: int
    blockades: int
    seed: int
    places_m: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    behind: dict[str, str] = field(default_factory=dict)
    """walled-off targets and the blockade before each"""

    def __post_init__(self) -> None:
        random = np.random.default_rng(self.seed)
        for letter, count in zip("ectb", self.counts, strict=True):
            for k in range(count):
                name = f"start-{letter}{k}" if letter in "ec" else f"{letter}{k}"
                self.places_m[name] = random.uniform(0.0, SIDE_M, 2)
                if letter == "t" and k % 10 == 9 and self.blockades:
                    self.behind[name] = f"b{k % self.blockades}"

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """Explorers, clearers, targets, blockades."""
        return (self.explorers, self.clearers, self.targets, self.blockades)

    def pddl(self) -> str:
        """The problem, for the disaster domain."""
        kinds = zip(("explorer", "clearer", "mission_target", "blockade"), self.counts, strict=True)
        objects = [
            f"{kind[0] if kind != 'mission_target' else 't'}{k} - {kind}"
            for kind, count in kinds
            for k in range(count)
        ]
        starts = [name for name in self.places_m if name.startswith("start")]
        objects += [f"{name} - free_location" for name in starts]
        init = [f"(at {name.removeprefix('start-')} {name})" for name in starts]
        goal = [f"(explored t{k})" for k in range(self.targets)]
        return (
            f"(define (problem field) (:domain disaster) (:objects {' '.join(objects)}) "
            f"(:init {' '.join(init)}) (:goal (and {' '.join(goal)})))"
        )

    def read(self) -> tuple[Problem, Attachments]:
        """The problem and what computes its modules."""
        domain = read_domain(catalogue.load("disaster").domain_path)
        attachments: Attachments = {
            "pathCost": Ways(self),
            "clearCost": lambda _robot, _blockade: CLEAR_S,
        }
        return read_problem(domain, self.pddl()), attachments

    def mission(self) -> Mission:
        """The same for the Hungarian method."""

        def at(letter: str, count: int, prefix: str = "") -> NDArray[np.float64]:
            return np.array([self.places_m[f"{prefix}{letter}{k}"] for k in range(count)])

        gates = [int(self.behind.get(f"t{k}", "b-1")[1:]) for k in range(self.targets)]
        return Mission(
            explorers_m=at("e", self.explorers, "start-"),
            clearers_m=at("c", self.clearers, "start-"),
            targets_m=at("t", self.targets),
            blockades_m=at("b", self.blockades),
            gates=np.array(gates),
            explorer_m_s=SPEED_M_S["e"],
            clearer_m_s=SPEED_M_S["c"],
            clear_s=CLEAR_S,
        )


class Ways:
    """Durations of ways, many at a time."""

    def __init__(self, field: Field) -> None:
        self._field = field

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        """Distance over speed [s]; infinite through the wall round a walled-off target."""
        places, behind = self._field.places_m, self._field.behind
        one = np.array([places[call[1]] for call in calls])
        other = np.array([places[call[2]] for call in calls])
        speed = np.array([SPEED_M_S[call[0][0]] for call in calls])
        took_s = np.hypot(*(one - other).T) / speed
        for k, (_, start, end) in enumerate(calls):
            if behind.get(end, start) != start or behind.get(start, end) != end:
                took_s[k] = np.inf
        return [float(value) for value in took_s]


def run(*, quick: bool) -> str:
    """CPU time to the first plan, best makespan of some seconds, and the Hungarian schedule's."""
    sizes = [(12, 8, 60, 20)] if quick else [(12, 8, 60, 20), (60, 40, 300, 100)]
    limit_s, seeds = (10.0, (1,)) if quick else (30.0, (1, 2, 3))
    rows = [_measured(Field(*size, seed), limit_s) for size in sizes for seed in seeds]
    columns = [
        "robots, targets, blockades",
        "seed",
        "first plan [CPU s]",
        "its makespan [s]",
        f"best after {limit_s:g} s",
        "Hungarian schedule",
        "shorter by",
    ]
    return table("Large teams", columns, rows)


def _measured(field: Field, limit_s: float) -> list[str]:
    plans: list[tuple[float, float]] = []
    begun_s = time.process_time()
    problem, attachments = field.read()
    solve(
        problem.domain,
        problem,
        attachments=attachments,
        timeout_s=limit_s,
        on_plan=lambda plan: plans.append((time.process_time() - begun_s, plan.makespan)),
    )
    greedy_s = hungarian_makespan_s(field.mission())
    size = f"{field.explorers + field.clearers}, {field.targets}, {field.blockades}"
    if not plans:
        return [size, str(field.seed), "-", "-", "-", f"{greedy_s:.0f}", "-"]
    (first_s, first), (_, best) = plans[0], plans[-1]
    shorter = f"{100 * (1 - best / greedy_s):+.1f} %"
    own = [f"{first_s:.2f}", f"{first:.0f}", f"{best:.0f}"]
    return [size, str(field.seed), *own, f"{greedy_s:.0f}", shorter]
