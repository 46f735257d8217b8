"""What is run: the two buildings of figure 2.8, large teams, short communication, the planner."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from scenarios.exploration.experiments import Experiment, drawn
from scenarios.exploration.one_run import RunParameters
from simulator.kinematic_exploration import KinematicParameters

SEEDS = (1, 2, 3, 4, 5)
"""of the buildings; parameters were chosen on others (from 100 on)"""
ARMS = ("nearest", "hungarian", "greedy", "segments by hand", "segments", "segments, thesis")


def experiments(*, quick: bool) -> list[Experiment]:
    """All experiments on drawn buildings."""
    starts = 3 if quick else 20
    short = RunParameters(kinematics=replace(KinematicParameters(), communication_range_m=10.0))
    small, large = drawn("small_rooms", SEEDS), drawn("large_rooms", SEEDS)
    if quick:
        return [
            Experiment("small_rooms", small, (4,), starts, ("nearest", "segments")),
            Experiment("large_rooms", large, (4,), starts, ("nearest", "segments")),
        ]
    return [
        Experiment("large_rooms", large, (2, 3, 4, 5, 6, 7, 8), starts, ARMS),
        Experiment("small_rooms", small, (2, 3, 4, 5, 6), starts, ARMS),
        Experiment(
            "large_rooms, large teams",
            large,
            (16, 32, 64),
            10,
            ("nearest", "segments, even", "segments"),
        ),
        Experiment(
            "large_rooms, 10 m communication", large, (4, 8), 10, ("nearest", "segments"), short
        ),
        Experiment("small_rooms, planner", small, (2, 4), 5, ("nearest", "segments", "planner")),
    ]


RESULTS = Path("docs") / "results" / "segments"
