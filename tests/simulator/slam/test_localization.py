import numpy as np
import pytest

from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.experiments.drive import Laser, OdometryNoise, Surveyor
from simulator.slam.experiments.floors import office_floor
from simulator.slam.localization import (
    LocalizationParameters,
    MonteCarloLocalization,
    SensorField,
    localize,
)
from simulator.slam.pose import between
from tests.simulator.slam.rooms import LASER, office_drive


def test_a_robot_finds_itself_in_a_map_from_anywhere() -> None:
    grid, _ = office_floor(11, 0, rooms=3)
    sensor_field = SensorField(grid, LocalizationParameters())
    drive = office_drive(0, 2)
    right, wrong = 0, 0
    for start in range(0, len(drive.scans) - 80, 80):
        posed = [(scan.odometry, scan) for scan in drive.scans[start : start + 80 : 2]]
        found = localize(sensor_field, posed, np.random.default_rng(start))
        if found is not None:
            away = between(drive.truth[start + 78], found.pose)
            good = np.hypot(away[0], away[1]) < 0.4 and abs(away[2]) < 0.2
            right, wrong = right + good, wrong + (not good)
    assert right >= 3
    assert wrong <= 1


def test_the_belief_stays_wide_where_places_look_alike() -> None:
    cells = np.full((100, 300), 100, dtype=np.int8)
    for left in (10, 110, 210):
        cells[10:90, left : left + 80] = 0
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    surveyor = Surveyor(grid)
    path = surveyor.path([(1.2, 1.2), (3.6, 1.2), (3.6, 3.6)])
    drive = surveyor.drive(path, LASER, OdometryNoise(), np.random.default_rng(0))
    posed = [(scan.odometry, scan) for scan in drive.scans]
    sensor_field = SensorField(grid, LocalizationParameters())
    assert localize(sensor_field, posed, np.random.default_rng(1)) is None


def test_particles_become_fewer_as_the_belief_narrows() -> None:
    grid, _ = office_floor(11, 0, rooms=3)
    drive = office_drive(0, 2)
    belief = MonteCarloLocalization(
        SensorField(grid, LocalizationParameters()), np.random.default_rng(0)
    )
    before = len(belief.particles)
    previous = drive.scans[0].odometry
    for scan in drive.scans[:80:2]:
        belief.move(between(previous, scan.odometry))
        belief.see(scan.points(0.3))
        previous = scan.odometry
    assert len(belief.particles) < 0.6 * before
    assert belief.weights.sum() == pytest.approx(1.0)


def test_a_map_without_walls_is_refused() -> None:
    empty = OccupancyGrid(np.zeros((10, 10), dtype=np.int8), 0.1, (0.0, 0.0))
    with pytest.raises(ValueError, match="without walls"):
        SensorField(empty, LocalizationParameters())


def test_the_laser_of_the_tests_is_a_half_circle() -> None:
    first, step = Laser().first_and_step()
    assert np.degrees([first, step]) == pytest.approx([-90.0, 1.0])
