"""Who has entered which room."""

import numpy as np

from scenarios.benchmarks.segments.two_robots import rooms_entered
from scenarios.exploration.buildings import Building
from simulator.kinematic_exploration import ExplorationResult
from simulator.occupancy_grid import OccupancyGrid


def test_rooms_are_entered_by_one_by_both_or_by_none() -> None:
    rooms = np.ones((30, 60), dtype=np.int32)
    rooms[10:, :20], rooms[10:, 20:40], rooms[10:, 40:] = 3, 4, 5
    truth = OccupancyGrid(np.zeros((30, 60), np.int8), 0.2, (0.0, 0.0))
    tracks = {
        # through the corridor, into rooms 3 and 4
        "a": np.array([[0.0, 1.0, 1.0], [1.0, 2.0, 4.0], [2.0, 6.0, 4.0]]),
        # into room 4; at the door of room 5 only
        "b": np.array([[0.0, 6.0, 4.5], [1.0, 10.0, 2.2]]),
    }
    result = ExplorationResult(
        duration_s=2.0,
        completed=True,
        driven_m={"a": 1.0, "b": 1.0},
        tracks=tracks,
        known_share=1.0,
        known_share_over_time=np.zeros((1, 2)),
        decisions=1,
        clusters=1,
        grid=truth,
    )
    assert rooms_entered(Building("b", 0, truth, rooms), result) == (1, 1, 1)
