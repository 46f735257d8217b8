"""What is run: the two buildings of figure 2.8, large teams, short radio, real buildings."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from scenarios.exploration.experiments import Experiment, drawn
from scenarios.exploration.one_run import RunParameters
from scenarios.exploration.real_buildings import (
    DATA,
    FREIBURG,
    HOSPITAL,
    building_079,
    hospital_section,
)
from simulator.kinematic_exploration import KinematicParameters

SEEDS = (1, 2, 3, 4, 5)
"""of the buildings; parameters were chosen on others (from 100 on)"""
STARTS = 20
BASELINE = "nearest"
ARMS = (BASELINE, "segments by hand", "segments", "greedy", "hungarian")
DEAR = ("planner", "segments, thesis")
"""a run takes three to ten times as long; in large rooms with one team only"""
RADIO_M = 10.0
RADIO = f"{RADIO_M:.0f} m radio"
LARGE_TEAMS = "large teams"
REAL_BUILDINGS = ("hospital section", "building 079")


def experiments(*, quick: bool, data: Path = DATA) -> list[Experiment]:
    """All experiments, those on real buildings as far as their maps are there."""
    small, large = drawn("small_rooms", SEEDS), drawn("large_rooms", SEEDS)
    short = RunParameters(kinematics=replace(KinematicParameters(), communication_range_m=RADIO_M))
    few = (BASELINE, "segments")
    if quick:
        return [
            Experiment("small_rooms", small, (4,), 3, few),
            Experiment("large_rooms", large, (4,), 3, few),
            Experiment(f"small_rooms, {RADIO}", small, (4,), 3, few, short),
        ]
    crowd = (BASELINE, "segments by hand", "segments", "segments, even")
    real = (BASELINE, "segments", "greedy")
    found = [
        Experiment("large_rooms", large, (2, 4, 6, 8), STARTS, ARMS),
        Experiment("small_rooms", small, (2, 3, 4, 5, 6), STARTS, (*ARMS, *DEAR)),
        Experiment("large_rooms", large, (4,), STARTS, DEAR),
        Experiment(f"small_rooms, {LARGE_TEAMS}", small, (8, 12, 16, 24), STARTS, crowd),
        Experiment(f"large_rooms, {LARGE_TEAMS}", large, (12, 24), STARTS, crowd),
        Experiment(f"small_rooms, {RADIO}", small, (4, 6), STARTS, few, short),
        Experiment(f"large_rooms, {RADIO}", large, (4, 8), STARTS, few, short),
    ]
    if (data / HOSPITAL).is_file():
        with_labels = (*real, "segments by hand")
        rooms = (lambda: hospital_section(data),)
        found.append(Experiment(REAL_BUILDINGS[0], rooms, (2, 4, 6), STARTS, with_labels))
    if (data / FREIBURG).is_file():
        offices = (lambda: building_079(data),)
        found.append(Experiment(REAL_BUILDINGS[1], offices, (2, 4, 6), STARTS, real))
    return found


RESULTS = Path("docs") / "results" / "segments"
