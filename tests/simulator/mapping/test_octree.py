import math
from pathlib import Path

import numpy as np
import octomap
import pytest
from numpy.typing import NDArray

from simulator.mapping.octree import MapFileError, OctreeMap, RayEnd, SensorModel

ORIGIN_M = np.array([0.3, 0.2, 0.1], dtype=np.float32)


def box_room(beams: int, seed: int) -> NDArray[np.float32]:
    """End points of beams in all directions from `ORIGIN_M` to the walls of a box of 16 x 13 x 4
    m."""
    directions = np.random.default_rng(seed).normal(size=(beams, 3))
    low, high = np.array([-7, -6, -1.5]), np.array([9, 7, 2.5])
    reach = np.where(directions > 0, (high - ORIGIN_M) / directions, (low - ORIGIN_M) / directions)
    return (ORIGIN_M + directions * reach.min(axis=1)[:, None]).astype(np.float32)


def probability(log_odds: float) -> float:
    return float(1 / (1 + np.exp(-log_odds)))


def reference(resolution_m: float, model: SensorModel) -> octomap.OcTree:
    tree = octomap.OcTree(resolution_m)
    tree.setProbHit(probability(model.hit))
    tree.setProbMiss(probability(model.miss))
    tree.setClampingThresMin(probability(model.lowest))
    tree.setClampingThresMax(probability(model.highest))
    return tree


def leaves(tree: octomap.OcTree, resolution_m: float) -> dict[tuple[int, ...], float]:
    """Log odds of every known voxel by integer key, pruned leaves expanded."""
    voxels: dict[tuple[int, ...], float] = {}
    for leaf in tree.begin_leafs():
        edge = round(leaf.getSize() / resolution_m)
        corner = np.round(np.array(leaf.getCoordinate()) / resolution_m - edge / 2).astype(int)
        for offset in np.ndindex(edge, edge, edge):
            voxels[tuple((corner + offset).tolist())] = leaf.getValue()
    return voxels


@pytest.fixture(scope="module")
def pair() -> tuple[OctreeMap, octomap.OcTree]:
    """The same three scans in our map and in OctoMap."""
    ours, theirs = OctreeMap(0.2), reference(0.2, SensorModel())
    for seed in range(3):
        scan = box_room(3000, seed)
        ours.insert_scan(ORIGIN_M, scan, max_range_m=8.0)
        theirs.insertPointCloud(scan.astype(float), ORIGIN_M.astype(float), 8.0)
    return ours, theirs


def test_every_voxel_has_the_log_odds_that_octomap_gives_it(
    pair: tuple[OctreeMap, octomap.OcTree],
) -> None:
    ours, theirs = pair
    centres, log_odds = ours.known_voxels()
    keys = np.round(centres / 0.2 - 0.5).astype(int)
    mine = dict(zip(map(tuple, keys.tolist()), log_odds.tolist(), strict=True))
    expected = leaves(theirs, 0.2)
    assert mine.keys() == expected.keys()
    for key, value in expected.items():
        assert mine[key] == pytest.approx(value, abs=1e-4)
    assert ours.node_count() == theirs.size()


def test_octomap_reads_back_what_was_written(
    pair: tuple[OctreeMap, octomap.OcTree], tmp_path: Path
) -> None:
    ours, theirs = pair
    ours.write(tmp_path / "room.ot")
    full = octomap.OcTree.read(bytes(tmp_path / "room.ot"))
    expected = leaves(theirs, 0.2)
    written = leaves(full, 0.2)
    assert written.keys() == expected.keys()
    assert all(written[key] == pytest.approx(expected[key], abs=1e-4) for key in expected)
    ours.write(tmp_path / "room.bt")
    theirs.writeBinary(bytes(tmp_path / "octomap.bt"))
    ours_bytes = (tmp_path / "room.bt").read_bytes().split(b"\ndata\n", 1)[1]
    assert ours_bytes == (tmp_path / "octomap.bt").read_bytes().split(b"\ndata\n", 1)[1]
    again = OctreeMap.read(tmp_path / "octomap.bt")
    assert np.array_equal(again.known_voxels()[0], ours.known_voxels()[0])


def test_rays_end_where_octomap_ends_them(pair: tuple[OctreeMap, octomap.OcTree]) -> None:
    ours, _ = pair
    theirs = reference(0.2, SensorModel())
    for seed in range(3):
        theirs.insertPointCloud(box_room(3000, seed).astype(float), ORIGIN_M.astype(float), 8.0)
    directions = np.random.default_rng(9).normal(size=(500, 3)).astype(np.float32)
    ends, positions_m = ours.cast_rays(ORIGIN_M, directions, max_range_m=6.0)
    for direction, end, position_m in zip(directions, ends, positions_m, strict=True):
        hit_m = np.zeros(3)
        hit = theirs.castRay(ORIGIN_M.astype(float), direction.astype(float), hit_m, False, 6.0)
        assert hit == (end == RayEnd.HIT)
        if hit:
            assert position_m == pytest.approx(hit_m, abs=1e-4)


def test_a_channel_keeps_its_own_odds() -> None:
    grass = OctreeMap(0.1)
    grass.add_channel("vegetation", SensorModel(hit=0.6, miss=-0.6, lowest=-3.0, highest=3.0))
    points = np.array([[0.05, 0.05, 0.05], [1.05, 0.05, 0.05]])
    grass.update_channel("vegetation", points, [True, False])
    grass.update_channel("vegetation", points, [True, False])
    assert grass.channel_log_odds("vegetation", points) == pytest.approx([1.2, -1.2])
    assert np.isnan(grass.log_odds(points)).all()
    with pytest.raises(KeyError, match='no channel "snow": add it first'):
        grass.update_channel("snow", points, [True, False])


def test_bad_input_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="resolution_m must be positive"):
        OctreeMap(0.0)
    with pytest.raises(ValueError, match=r"hit = 0\.87 is not a multiple of the quantum"):
        OctreeMap(0.1, SensorModel(hit=0.87))
    with pytest.raises(ValueError, match=r"points have shape \(3,\)"):
        OctreeMap(0.1).log_odds([0.0, 0.0, 0.0])
    (tmp_path / "empty.bt").write_bytes(b"")
    with pytest.raises(MapFileError, match=r"empty\.bt: not an OctoMap file"):
        OctreeMap.read(tmp_path / "empty.bt")


def test_a_channel_takes_measurements_of_any_certainty() -> None:
    grass = OctreeMap(0.1)
    grass.add_channel("vegetation", SensorModel(hit=1.0, miss=-1.0, lowest=-3.0, highest=3.0))
    points = [[0.05, 0.05, 0.05], [0.15, 0.05, 0.05], [0.25, 0.05, 0.05]]
    grass.add_to_channel("vegetation", points, [0.7, -0.2, math.nan])
    grass.add_to_channel("vegetation", points, [0.35, -5.0, math.nan])
    found = grass.channel_log_odds("vegetation", points)
    assert found[:2] == pytest.approx([1.05, -3.0])
    assert math.isnan(found[2])
    with pytest.raises(KeyError, match='no channel "snow"'):
        grass.add_to_channel("snow", points, [0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="one value a point"):
        grass.add_to_channel("vegetation", points, [0.0])
