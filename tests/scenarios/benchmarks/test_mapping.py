"""The parts of the mapping experiments that their tables rest on."""

import numpy as np
import pytest

from scenarios.benchmarks.mapping.beside_octomap import heap_bytes
from scenarios.benchmarks.mapping.memory import mapped, sizes
from scenarios.benchmarks.mapping.octomap_peer import octomap_tree
from scenarios.benchmarks.mapping.worlds import Scan, World, small_room, sphere_of_beams
from simulator.mapping.octree import SensorModel


def test_the_octree_that_is_reckoned_is_octomaps() -> None:
    room = small_room(beams=5000, scans=2)
    found = sizes(mapped(room, 0.1, 5.0))
    tree = octomap_tree(0.1, SensorModel())
    for scan in room.scans:
        tree.insertPointCloud(scan.points_m.astype(float), scan.origin_m, 5.0)
    # OctoMap adds the size of the tree object itself.
    assert found.octree_pruned == pytest.approx(tree.memoryUsage(), abs=1000)
    assert found.octree > found.octree_pruned
    assert found.bricks >= found.bricks_collapsed
    assert found.file_all > found.file_binary


def test_a_full_grid_spans_the_known_voxels() -> None:
    scan = Scan(np.array([0.05, 0.05, 0.05]), np.array([[0.95, 0.05, 0.05]], dtype=np.float32))
    found = sizes(mapped(World("beam", "", [scan]), 0.1, None))
    assert found.voxels == 10
    assert found.grid == 4 * 10


def test_beams_are_unit_vectors_all_around() -> None:
    beams = sphere_of_beams(10_000)
    assert len(beams) == pytest.approx(10_000, rel=0.02)
    assert np.linalg.norm(beams, axis=1) == pytest.approx(1.0)
    assert np.abs(beams[:, :2].mean(axis=0)).max() < 1e-2


def test_what_is_handed_out_is_counted() -> None:
    before = heap_bytes()
    block = np.ones(10**6)
    assert heap_bytes() - before == pytest.approx(block.nbytes, rel=0.01)
