"""What is run: the two buildings of figure 2.8, large teams, short communication, the planner."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from scenarios.exploration.experiments import Experiment, drawn
from scenarios.exploration.one_run import RunParameters
from simulator.kinematic_exploration import KinematicParameters

SEEDS = (1, 2, 3, 4, 5)
"""of the buildings; parameters were chosen on others (from 100 on)"""
CORE = ("nearest", "segments by hand", "segments")
OTHERS = ("hungarian", "greedy")


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
    crowd = ("nearest", "segments, even", "segments")
    letter = ("nearest", "segments", "segments, thesis")
    planner = ("nearest", "segments", "planner")
    return [
        Experiment("large_rooms", large, (2, 4, 6, 8), starts, CORE),
        Experiment("small_rooms", small, (2, 3, 4, 5, 6), starts, CORE),
        Experiment("large_rooms", large, (2, 4, 6, 8), 6, OTHERS),
        Experiment("small_rooms", small, (2, 3, 4, 5, 6), 6, (*OTHERS, "segments, thesis")),
        Experiment("small_rooms, planner", small, (2, 4), 5, planner),
        Experiment("large_rooms, to the letter", large, (4, 8), 6, letter),
        Experiment("small_rooms, large teams", small, (12, 24), 6, crowd),
        Experiment("large_rooms, 10 m radio", large, (4, 8), 4, ("nearest", "segments"), short),
    ]


RESULTS = Path("docs") / "results" / "segments"
