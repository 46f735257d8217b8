import numpy as np
import pytest

from simulator.vegetation.features import Measurements
from simulator.vegetation.remission_correction import corrected_remission
from simulator.vegetation.simulation.remission_model import (
    LMS_151,
    LMS_291,
    SCANNERS,
    UTM_30LX,
    Material,
    Scanner,
    reflectances,
    remission,
)


def reported(scanner: Scanner, material: Material, range_m: float, count: int = 4000) -> np.ndarray:
    """Remissions on level ground below a scanner 0.6 m high."""
    ranges = np.full(count, range_m)
    angles = np.arccos(np.minimum(0.6 / ranges, 1.0))
    kinds = np.full(count, material, np.uint8)
    random = np.random.default_rng(int(material))
    return remission(scanner, kinds, ranges, angles, reflectances(0, 0.0), random)


def separation(scanner: Scanner, range_m: float) -> float:
    """Distance of the class means over the mean deviation."""
    street, lawn = (reported(scanner, kind, range_m) for kind in (Material.ASPHALT, Material.LAWN))
    return float((lawn.mean() - street.mean()) / (0.5 * (lawn.std() + street.std())))


@pytest.mark.parametrize("name", sorted(SCANNERS))
@pytest.mark.parametrize("range_m", [0.65, 1.0, 2.0, 4.5])
def test_grass_reflects_more_than_tiles_and_tiles_more_than_asphalt(
    name: str, range_m: float
) -> None:
    """Section 6.3 and figure 6.6."""
    kinds = (Material.ASPHALT, Material.LIGHT_TILES, Material.LAWN)
    # Tiles obey Lambert's law, so that at grazing angles they come close to asphalt.
    kinds = kinds if range_m < 2.5 else (Material.ASPHALT, Material.LAWN)
    means = [reported(SCANNERS[name], kind, range_m).mean() for kind in kinds]
    assert means == sorted(means)


def test_the_scanners_differ_as_in_section_6_6() -> None:
    """Near range: LMS 291 separates best, then LMS 151; the UTM-30LX overlaps below 1 m only."""
    near = [separation(scanner, 0.65) for scanner in (LMS_291, LMS_151, UTM_30LX)]
    assert near[0] > near[1] > near[2]
    assert separation(UTM_30LX, 2.0) > separation(UTM_30LX, 0.65)


def test_remission_falls_with_range_beyond_the_near_range() -> None:
    for scanner in SCANNERS.values():
        means = [reported(scanner, Material.LAWN, r).mean() for r in (1.5, 2.5, 3.5, 4.5)]
        assert means == sorted(means, reverse=True)


def test_the_correction_leaves_a_dependency_on_range() -> None:
    """Figure 6.11: the scanner's response is not linear."""
    means = []
    for range_m in (1.0, 4.5):
        values = reported(LMS_291, Material.LAWN, range_m)
        angle = float(np.arccos(0.6 / range_m))
        count = len(values)
        measured = Measurements(np.full(count, range_m), np.full(count, angle), values)
        means.append(corrected_remission(measured).mean())
    assert max(means) > 2 * min(means)


def test_places_differ() -> None:
    assert not np.allclose(reflectances(1), reflectances(2))
    assert np.array_equal(reflectances(1), reflectances(1))
