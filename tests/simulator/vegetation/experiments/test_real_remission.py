from pathlib import Path

import numpy as np
import pytest

from simulator.vegetation.experiments.real_remission import (
    GUARD_M,
    Ground,
    ground_points,
    held_out,
)
from simulator.vegetation.real_data.labelled_scan import (
    RELLIS_CONCRETE,
    RELLIS_GRASS,
    LabelledScan,
    read_rellis,
)

DATA = Path(__file__).parents[5] / "shared" / "data"
ROUGH = "range, angle, roughness at four scales"
THESIS = "range, angle, remission (thesis)"


def accuracy(ground: Ground, name: str, folds: np.ndarray, guard_m: float) -> float:
    return float(np.mean(held_out(ground, folds, guard_m, [name])[name] == ground.vegetation))


def synthetic_scan() -> LabelledScan:
    """Rings of ground around the sensor; every other patch of 45 degrees is rough grass."""
    random = np.random.default_rng(1)
    azimuth, range_m = random.uniform(-np.pi, np.pi, 2500), random.uniform(3, 7, 2500)
    grass = np.floor(azimuth / (np.pi / 4)) % 2 == 0
    height = -1.2 + random.normal(0, 1, 2500) * np.where(grass, 0.04, 0.004)
    points = np.column_stack([range_m * np.cos(azimuth), range_m * np.sin(azimuth), height])
    remission = random.normal(np.where(grass, 1.3, 1.0), 0.4)
    label = np.where(grass, RELLIS_GRASS, RELLIS_CONCRETE).astype(np.uint32)
    return LabelledScan(points, remission, label)


def test_roughness_tells_what_single_beams_do_not() -> None:
    ground = ground_points(synthetic_scan(), [RELLIS_GRASS], [RELLIS_CONCRETE], every=4)
    quadrants = ground.sector // 3
    rough = accuracy(ground, ROUGH, quadrants, 0.5)
    assert rough > 0.85
    assert rough > accuracy(ground, THESIS, quadrants, 0.5) + 0.1


def test_no_test_sector_is_trained_on() -> None:
    """Labels that only the sector tells cannot be learned from the other sectors."""
    scan = synthetic_scan()
    sector = ((scan.azimuth_rad() + np.pi) // np.deg2rad(30)).astype(int)
    coin = np.random.default_rng(2).random(12) < 0.5
    label = np.where(coin[sector], RELLIS_GRASS, RELLIS_CONCRETE).astype(np.uint32)
    scan = LabelledScan(
        scan.points_m, scan.remission * 0 + np.random.default_rng(3).normal(size=len(label)), label
    )
    ground = ground_points(scan, [RELLIS_GRASS], [RELLIS_CONCRETE], every=8)
    assert accuracy(ground, ROUGH, ground.sector, 0.0) < 0.75


@pytest.mark.slow
def test_rellis_quadrants_with_a_guard() -> None:
    path = DATA / "rellis" / "000104.bin"
    if not path.is_file():
        pytest.skip(f"RELLIS-3D is not in {DATA}")
    scan = read_rellis(path, path.with_suffix(".label"))
    ground = ground_points(scan, [RELLIS_GRASS], [RELLIS_CONCRETE], every=4)
    assert accuracy(ground, ROUGH, ground.sector // 3, GUARD_M) > 0.88
