import numpy as np
import pytest

from simulator.slam.experiments.floors import office_floor
from simulator.slam.pose import compose, inverse, transform
from simulator.slam.robot_map import RobotMap, grid_of_scans, map_with_known_poses
from tests.simulator.slam.rooms import node_truth, office_drive, office_map


def test_the_map_shows_walls_where_they_are() -> None:
    drive, robot_map = office_drive(0, 1), office_map(0, 1)
    first = node_truth(robot_map, drive)[0]
    world = robot_map.with_graph(
        robot_map.graph.moved(compose(first, inverse(robot_map.graph.poses[0])))
    )
    grid = map_with_known_poses([world], 0.1)
    floor, _ = office_floor(11, 0, rooms=3)
    rows, columns = np.nonzero(grid.cells >= 60)
    at = (np.stack([columns, rows], axis=1) + 0.5) * 0.1 + np.array(grid.origin_m)
    cell = np.floor(at / floor.resolution_m).astype(int)
    near = [
        bool(floor.walls()[max(r - 3, 0) : r + 4, max(c - 3, 0) : c + 4].any()) for c, r in cell
    ]
    assert len(near) > 300
    assert np.mean(near) > 0.97


def test_a_wall_behind_the_reach_is_not_drawn() -> None:
    drive = office_drive(0, 1)
    posed = [(drive.truth[0], drive.scans[0])]
    far = grid_of_scans(posed, 0.1)
    near = grid_of_scans(posed, 0.1, reach_m=2.0)
    ends = transform(drive.truth[0], drive.scans[0].points())
    assert np.count_nonzero(near.cells >= 50) < np.count_nonzero(far.cells >= 50)
    assert np.hypot(*(ends - drive.truth[0][:2]).T).max() > 2.0


def test_a_map_needs_scans() -> None:
    with pytest.raises(ValueError, match="at least one scan"):
        map_with_known_poses([RobotMap("r", office_map(0, 1).graph)])
