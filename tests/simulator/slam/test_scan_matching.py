import math

import numpy as np
import pytest

from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.experiments.drive import Laser, Surveyor
from simulator.slam.pose import between, compose
from simulator.slam.range_scan import RangeScan
from simulator.slam.scan_matching import ScanMatchParameters, match, surfaces

LASER = Laser(range_m=12.0, noise_m=0.01)


def room(width_m: float, height_m: float, pillar: bool) -> Surveyor:
    cells = np.full((round(height_m / 0.05), round(width_m / 0.05)), 100, dtype=np.int8)
    cells[4:-4, 4:-4] = 0
    if pillar:
        cells[40:52, 60:80] = 100
    return Surveyor(OccupancyGrid(cells, 0.05, (0.0, 0.0)))


def seen(surveyor: Surveyor, pose: tuple[float, float, float], seed: int) -> RangeScan:
    random = np.random.default_rng(seed)
    return surveyor.scan(np.array(pose), LASER, np.zeros(3), 0.0, random)


@pytest.mark.parametrize("error", [(0.2, -0.1, 0.1), (-0.25, 0.2, -0.15), (0.0, 0.0, 0.0)])
def test_a_scan_is_placed_within_a_centimetre(error: tuple[float, float, float]) -> None:
    surveyor = room(8.0, 6.0, pillar=True)
    first, second = (1.5, 1.2, 0.6), (1.8, 1.3, 0.75)
    reference = surfaces([(np.zeros(3), seen(surveyor, first, 1))])
    truth = between(first, second)
    found = match(reference, seen(surveyor, second, 2), compose(truth, error), (0.3, 0.2))
    assert found is not None
    assert np.all(np.abs(found.pose - truth) < (0.015, 0.015, 0.006))
    assert found.score > 0.8


def test_the_covariance_is_honest() -> None:
    surveyor = room(8.0, 6.0, pillar=True)
    first, second = (1.5, 1.2, 0.6), (1.9, 1.3, 0.7)
    truth = between(first, second)
    errors = []
    for seed in range(30):
        reference = surfaces([(np.zeros(3), seen(surveyor, first, seed))])
        found = match(reference, seen(surveyor, second, seed + 100), truth, (0.1, 0.05))
        assert found is not None
        away = between(truth, found.pose)
        errors.append(float(away @ found.information @ away))
    # The mean of a chi-square variable with three degrees of freedom is three.
    assert np.mean(errors) < 6.0


def corridor_match(debias: bool, prior: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    surveyor = room(60.0, 2.4, pillar=False)
    first, second = (20.0, 1.2, 0.0), (20.5, 1.2, 0.0)
    reference = surfaces([(np.zeros(3), seen(surveyor, first, 1))])
    guess = np.array([0.5, 0.0, 0.0])
    parameters = ScanMatchParameters(debias=debias)
    found = match(reference, seen(surveyor, second, 2), guess, (0.3, 0.1), parameters, prior=prior)
    assert found is not None
    return found.pose, found.information


def test_along_a_bare_corridor_the_odometry_decides() -> None:
    pose, information = corridor_match(True, np.diag([100.0, 100.0, 100.0]))
    assert pose[0] == pytest.approx(0.5, abs=0.01)
    assert information[0, 0] < 1.0 < information[1, 1]
    _, pretended = corridor_match(False, None)
    assert pretended[0, 0] > 10.0


def test_what_fits_nowhere_is_no_match() -> None:
    reference = surfaces([(np.zeros(3), seen(room(8.0, 6.0, pillar=True), (1.5, 1.2, 0.6), 1))])
    other = seen(room(30.0, 2.0, pillar=False), (15.0, 1.0, 0.8), 2)
    strict = ScanMatchParameters(least_score=0.6)
    assert match(reference, other, np.zeros(3), (0.3, 0.2), strict) is None


def test_scans_without_a_hit_are_refused() -> None:
    empty = RangeScan(0.0, np.full(90, 8.0, np.float32), 0.0, math.pi / 90, 8.0, np.zeros(3))
    with pytest.raises(ValueError, match="no beam"):
        surfaces([(np.zeros(3), empty)])
