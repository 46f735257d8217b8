import numpy as np

from simulator.slam.experiments.drive import Laser, OdometryNoise, Surveyor, along
from simulator.slam.experiments.floors import office_floor
from simulator.slam.pose import between


def test_poses_along_a_line_turn_on_the_spot_at_its_corners() -> None:
    poses = along([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)], 0.5)
    steps = between(poses[:-1], poses[1:])
    assert np.hypot(steps[:, 0], steps[:, 1]).max() < 0.51
    assert np.abs(steps[:, 2]).max() < 0.31
    assert np.allclose(poses[-1], [2.0, 1.0, np.pi / 2])


def test_odometry_without_noise_is_the_truth() -> None:
    grid, stops = office_floor(3, 0, rooms=2)
    surveyor = Surveyor(grid)
    path = surveyor.path(stops)[:40]
    quiet = OdometryNoise(0.0, 0.0, 0.0)
    drive = surveyor.drive(path, Laser(), quiet, np.random.default_rng(0))
    odometry = np.array([scan.odometry for scan in drive.scans])
    assert np.allclose(between(path[0], path), odometry, atol=1e-9)


def test_end_points_lie_on_walls() -> None:
    grid, stops = office_floor(3, 0, rooms=2)
    surveyor = Surveyor(grid)
    laser = Laser(noise_m=0.0)
    pose = surveyor.path(stops)[20]
    scan = surveyor.scan(pose, laser, np.zeros(3), 0.0, np.random.default_rng(0))
    bearing = pose[2] + scan.bearings_rad()[scan.hits()]
    reach = scan.ranges_m[scan.hits()] + 0.02
    columns = ((pose[0] + reach * np.cos(bearing)) / grid.resolution_m).astype(int)
    rows = ((pose[1] + reach * np.sin(bearing)) / grid.resolution_m).astype(int)
    assert grid.walls()[rows, columns].mean() > 0.97
