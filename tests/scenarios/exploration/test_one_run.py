"""Strategies of the service explore drawn buildings completely."""

import pytest

from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import generated
from scenarios.exploration.one_run import gathered_starts, row_of

NAMES = sorted(set(ARMS) - {"planner"})


@pytest.mark.parametrize("arm", NAMES)
def test_every_strategy_explores_all_of_a_building(arm: str) -> None:
    building = generated("small_rooms", 3)
    row = row_of(building, 3, 1, ARMS[arm](building), strategy_name=arm)
    assert row["status"] == "completed"
    assert row["known_share"] > 0.99
    assert 60.0 < row["duration_s"] < 400.0
    assert row["longest_drive_m"] <= 0.5 * row["duration_s"] + 1.0


def test_the_temporal_planner_explores_as_well() -> None:
    building = generated("small_rooms", 3)
    row = row_of(building, 2, 1, ARMS["planner"](building), strategy_name="planner")
    assert row["status"] == "completed"
    assert row["known_share"] > 0.99


def test_runs_repeat() -> None:
    building = generated("small_rooms", 4)
    one, other = (
        row_of(building, 6, 5, ARMS["segments"](building), strategy_name="segments")
        for _ in range(2)
    )
    assert one["duration_s"] == other["duration_s"]
    assert one["driven_m"] == other["driven_m"]


def test_robots_start_side_by_side() -> None:
    building = generated("large_rooms", 1)
    poses = gathered_starts(building, 12, 3, 0.8)
    xs, ys = [p[0] for p in poses], [p[1] for p in poses]
    assert len(poses) == 12
    assert max(xs) - min(xs) < 8.0
    assert max(ys) - min(ys) < 8.0
    assert gathered_starts(building, 12, 3, 0.8) == poses
    assert gathered_starts(building, 12, 4, 0.8) != poses
