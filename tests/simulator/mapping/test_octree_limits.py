"""Bounded memory, reach beyond 16 bits, array export, projections and information gain."""

from pathlib import Path

import numpy as np
import pytest

from simulator.mapping.octree import MapFileError, MapFullError, OctreeMap, SensorModel

RIGHT = np.array([1.0, 0.0, 0.0])


def ring(beams: int = 3000) -> np.ndarray:
    angles = np.linspace(0, 2 * np.pi, beams, endpoint=False)
    height = np.linspace(-0.4, 0.4, beams)
    return np.stack([4 * np.cos(angles), 4 * np.sin(angles), height], axis=1)


def test_a_scan_that_does_not_fit_leaves_the_map_as_it_was() -> None:
    free = OctreeMap(0.1)
    free.insert_scan([0, 0, 0], ring())
    needed = free.memory_bytes()
    bounded = OctreeMap(0.1, memory_limit_bytes=needed)
    bounded.insert_scan([0, 0, 0], ring())
    before = bounded.to_bytes(".ot")
    with pytest.raises(MapFullError, match=f"limit of {needed} bytes"):
        bounded.insert_scan([20, 0, 0], ring() + np.array([20, 0, 0]))
    assert bounded.to_bytes(".ot") == before
    with pytest.raises(MapFullError):
        OctreeMap(0.001, memory_limit_bytes=10_000).insert_scan([0, 0, 0], ring())


def test_a_map_that_forgets_what_lies_behind_stays_small() -> None:
    rolling, growing = OctreeMap(0.1), OctreeMap(0.1)
    sizes = []
    for x in range(0, 100, 5):
        for octree in (rolling, growing):
            octree.insert_scan([x, 0, 0], ring() + np.array([x, 0, 0]))
        rolling.forget_outside(([x - 6, -6, -6], [x + 6, 6, 6]))
        sizes.append(rolling.memory_bytes())
    assert max(sizes[2:]) <= 1.5 * sizes[2]
    assert growing.memory_bytes() > 5 * sizes[-1]
    near = ([93, -4, -1], [97, 4, 1])
    assert np.array_equal(rolling.known_voxels(near)[1], growing.known_voxels(near)[1])


def test_a_file_larger_than_the_limit_is_refused(tmp_path: Path) -> None:
    octree = OctreeMap(0.1)
    octree.insert_scan([0, 0, 0], ring())
    octree.write(tmp_path / "ring.ot")
    with pytest.raises(MapFileError, match=r"ring\.ot: the map would take more than its limit"):
        OctreeMap.read(tmp_path / "ring.ot", memory_limit_bytes=1000)


def test_keys_reach_beyond_sixteen_bits() -> None:
    # 65,536 voxels of 0.01 m are 655 m; this wall stands a kilometre away.
    octree = OctreeMap(0.01)
    octree.insert_scan([1000.005, 0.005, 0.005], [[1000.505, 0.005, 0.005]])
    assert octree.log_odds([[1000.505, 0.005, 0.005]]) == pytest.approx([0.85])
    ends, positions_m = octree.cast_rays([1000.005, 0.005, 0.005], RIGHT[None], 2.0)
    assert ends.tolist() == [0]
    assert positions_m[0, 0] == pytest.approx(1000.505, abs=1e-3)
    with pytest.raises(ValueError, match="65536 voxels a side"):
        octree.to_bytes(".ot")
    with pytest.raises(ValueError, match="beyond the map's reach"):
        octree.set_log_odds([[1e9, 0.0, 0.0]], [1.0])


def test_leaves_cover_the_known_voxels_once() -> None:
    octree = OctreeMap(0.1)
    directions = np.random.default_rng(1).normal(size=(20_000, 3))
    sphere = 1.5 * directions / np.linalg.norm(directions, axis=1)[:, None]
    for _ in range(6):
        octree.insert_scan([0.0, 0.0, 0.05], sphere)
    centres, edges, log_odds = octree.leaves()
    voxels, values = octree.known_voxels()
    assert np.round((edges / 0.1) ** 3).sum() == len(voxels)
    assert edges.max() > 0.15
    assert octree.log_odds(centres - edges[:, None] / 2 + 0.05) == pytest.approx(log_odds)
    assert np.round((edges / 0.1) ** 3)[log_odds >= 0].sum() == (values >= 0).sum()
    leaves, inner = octree.unpruned_counts()
    assert leaves == len(voxels)
    assert len(centres) < octree.node_count() < leaves + inner


def test_columns_hold_the_maximum_of_a_band() -> None:
    octree = OctreeMap(0.1)
    octree.set_log_odds([[0.05, 0.05, 0.05], [0.05, 0.05, 0.35], [0.25, 0.15, 0.25]], [-2, 1, -1])
    corner, maxima = octree.column_maxima(0.0, 0.3, ((0, 0), (2, 1)))
    assert corner == (0, 0)
    expected = [[-2, np.nan, np.nan], [np.nan, np.nan, -1]]
    assert maxima == pytest.approx(np.array(expected), nan_ok=True)
    assert octree.column_maxima(0.0, 0.4, ((0, 0), (0, 0)))[1].item() == pytest.approx(1.0)


def test_gain_counts_unknown_voxels_that_beams_are_expected_to_reach() -> None:
    # Section 5.4 by hand: free, unknown, unknown, occupied along x; three outcomes of a beam.
    octree = OctreeMap(1.0)
    octree.set_log_odds([[0.5, 0.5, 0.5], [3.5, 0.5, 0.5]], [-0.4, 0.85])

    def entropy(log_odds: float) -> float:
        p = 1 / (1 + np.exp(-log_odds))
        return float(-p * np.log(p) - (1 - p) * np.log(1 - p))

    model = SensorModel()
    miss, hit = (np.log(2) - entropy(value) for value in (model.miss, model.hit))
    gain = octree.information_gain([[0.5, 0.5, 0.5]], RIGHT[None, None], 10.0)
    assert gain == pytest.approx([(2 * miss + hit) / 3 + (miss + hit) / 3])
    beyond = ([2, 0, 0], [9, 1, 1])
    part = octree.information_gain([[0.5, 0.5, 0.5]], RIGHT[None, None], 10.0, beyond)
    assert part == pytest.approx([(miss + hit) / 3])
    two = octree.information_gain([[0.5, 0.5, 0.5]] * 2, np.tile(RIGHT, (2, 4, 1)), 10.0, threads=2)
    assert two == pytest.approx([gain[0], gain[0]])
