from pathlib import Path

import numpy as np
import pytest

from simulator.slam.carmen import read_carmen
from simulator.slam.front_end import FrontEnd, FrontEndParameters, build_map
from simulator.slam.pose import compose
from simulator.slam.pose_graph import absolute_trajectory_error_m
from tests.simulator.slam.rooms import node_truth, office_drive, office_map

DATA = Path(__file__).parents[4] / "shared" / "data"


def test_slam_takes_most_of_the_drift_out() -> None:
    drive, robot_map = office_drive(0, 1), office_map(0, 1)
    truth = node_truth(robot_map, drive)
    odometry = np.array([robot_map.scans[key].odometry for key in sorted(robot_map.scans)])
    error_m = absolute_trajectory_error_m(robot_map.graph.trajectory(), truth)
    assert error_m < 0.06
    assert error_m < 0.2 * absolute_trajectory_error_m(odometry, truth)
    assert sum(edge.kind == "loop" for edge in robot_map.graph.edges) >= 3


def test_a_robot_knows_where_it_is_between_nodes() -> None:
    drive = office_drive(0, 1)
    front_end = FrontEnd("r", FrontEndParameters(loops=None))
    assert front_end.add(drive.scans[0])
    assert not front_end.add(drive.scans[0])
    step = compose(drive.scans[0].odometry, np.array([0.1, 0.0, 0.05]))
    assert np.allclose(front_end.pose(step), [0.1, 0.0, 0.05])


def test_the_same_log_gives_the_same_graph() -> None:
    scans = office_drive(0, 1).scans[:80]
    once, again = build_map("r", scans), build_map("r", scans)
    assert np.array_equal(once.graph.trajectory(), again.graph.trajectory())


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
def test_the_intel_lab_is_mapped_as_others_have() -> None:
    scans = read_carmen(DATA / "carmen_raw" / "intel.clf.bz2", 20.0)
    reference = {
        scan.ranges_m[:60].round(2).tobytes(): scan.odometry
        for scan in read_carmen(DATA / "carmen" / "intel-corrected.log.gz", 20.0)
    }
    robot_map = build_map("intel", scans)
    estimate, truth = [], []
    for key in sorted(robot_map.scans):
        pose = reference.get(robot_map.scans[key].ranges_m[:60].round(2).tobytes())
        if pose is not None:
            estimate.append(robot_map.graph.poses[key])
            truth.append(pose)
    assert len(truth) > 50
    assert absolute_trajectory_error_m(np.array(estimate), np.array(truth)) < 0.2
