"""Kinematic exploration: the map grows from scans, and groups that part know different things."""

import numpy as np

from simulator.kinematic_exploration import (
    Errand,
    KinematicExploration,
    KinematicParameters,
    TeamView,
)
from simulator.occupancy_grid import OccupancyGrid

NOTHING = np.empty(0, dtype=np.int64)


def hall(columns: int = 150) -> OccupancyGrid:
    """A hall 3 m wide, 0.2 m cells."""
    cells = np.full((17, columns), 100, dtype=np.int8)
    cells[1:-1, 1:-1] = 0
    return OccupancyGrid(cells, 0.2, (0.0, 0.0))


class Eastward:
    """Sends every robot straight to an x, once."""

    def __init__(self, goals_x_m: dict[str, float]) -> None:
        self.goals_x_m = goals_x_m
        self.views: list[TeamView] = []

    def __call__(self, view: TeamView) -> dict[str, Errand]:
        self.views.append(view)
        errands = {}
        for robot, (x, y) in view.positions_m.items():
            goal = self.goals_x_m[robot]
            if abs(goal - x) > 0.1:
                # A purpose that is never served: the robot drives to the end.
                errands[robot] = Errand(np.array([[x, y], [goal, y]]), np.array([0]))
        return errands


def test_robots_drive_at_their_speed_and_map_what_they_pass() -> None:
    run = KinematicExploration(hall(), {"a": (1.5, 1.7, 0.0)}, KinematicParameters(speed_m_s=0.5))
    result = run.run(Eastward({"a": 21.5}))
    assert result.completed
    assert result.duration_s == 40.0
    assert abs(result.driven_m["a"] - 20.0) < 1e-6
    known = result.grid.cells >= 0
    assert known[8, :130].all()
    assert not known[8, 140:].any()
    truth = hall().cells
    assert ((result.grid.cells[known] >= 50) == (truth[known] >= 50)).mean() > 0.999
    shares = result.known_share_over_time[:, 1]
    assert (np.diff(shares) >= 0).all()
    assert shares[-1] > 0.85


def test_a_forward_looking_sensor_sees_nothing_behind_while_driving() -> None:
    parameters = KinematicParameters(field_of_view_rad=np.pi, sensor_range_m=3.0)
    run = KinematicExploration(hall(), {"a": (14.5, 1.7, 0.0)}, parameters)
    view = Eastward({"a": 20.5})
    result = run.run(view)
    assert (result.grid.cells[8, 90:115] >= 0).all()
    assert (result.grid.cells[8, 30:50] < 0).all()


def test_groups_out_of_range_know_different_maps_until_they_meet() -> None:
    parameters = KinematicParameters(communication_range_m=8.0, sensor_range_m=3.0)
    starts = {"west": (1.5, 1.7, 0.0), "east": (27.5, 1.7, 0.0)}
    decide = Eastward({"west": 15.5, "east": 20.5})
    result = KinematicExploration(hall(), starts, parameters).run(decide)
    assert result.clusters == 2
    first = [view for view in decide.views if view.time_s == 0.0]
    assert [list(view.positions_m) for view in first] == [["west"], ["east"]]
    assert (first[0].grid.cells[8, 120:] < 0).all()
    assert (first[1].grid.cells[8, :30] < 0).all()
    together = [view for view in decide.views if len(view.positions_m) == 2]
    assert together
    assert (together[0].grid.cells[8, 5:20] >= 0).all()
    assert (together[0].grid.cells[8, 130:145] >= 0).all()


def test_robots_that_part_do_not_hear_what_others_learn_later() -> None:
    parameters = KinematicParameters(communication_range_m=4.0, sensor_range_m=3.0)
    starts = {"stays": (1.5, 1.7, 0.0), "leaves": (3.0, 1.7, 0.0)}
    decide = Eastward({"stays": 1.5, "leaves": 22.5})
    result = KinematicExploration(hall(), starts, parameters).run(decide)
    assert result.clusters == 2
    alone = [view for view in decide.views if list(view.positions_m) == ["stays"]]
    assert alone
    assert (alone[-1].grid.cells[8, 80:] < 0).all()
    assert (result.grid.cells[8, 80:110] >= 0).all()


def test_a_run_repeats() -> None:
    def once() -> list[object]:
        result = KinematicExploration(hall(), {"a": (1.5, 1.7, 0.3)}).run(Eastward({"a": 9.5}))
        return [result.duration_s, result.driven_m, result.grid.cells.tobytes()]

    assert once() == once()
