"""The same scans in our map and in OctoMap: equal content, CPU time, memory, rays."""

from __future__ import annotations

import ctypes
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenarios.benchmarks.mapping.octomap_peer import octomap_tree
from scenarios.benchmarks.mapping.worlds import Scan, World, building_079, corridor, tilt_scan
from simulator.mapping.octree import OctreeMap, RayEnd, SensorModel

RANGE_M = 10.0
BEAMS = 100_000


def measure(*, quick: bool) -> str:
    """A table of ratios, theirs over ours, each of one run."""
    worlds = [tilt_scan(), building_079(BEAMS, 3), corridor(BEAMS, 3)]
    heads = [
        "world",
        "voxel",
        "voxels that differ",
        "largest difference of log odds",
        "CPU s for 100,000 beams: ours, OctoMap",
        "faster",
        "MB on the heap: ours, OctoMap",
        "smaller",
        "MB by own account",
        "microseconds a ray: ours, OctoMap, its call alone",
        "faster (without call)",
    ]
    rows = [heads, ["---"] * len(heads)]
    for world in worlds:
        for resolution_m in (0.1,) if quick else (0.1, 0.05):
            if world is not None:
                rows.append(_compare(world, resolution_m, rays=2_000 if quick else 20_000))
    lines = [f"| {' | '.join(row)} |" for row in rows]
    if worlds[0] is None:
        lines.append("\nThe real scans are not here: only simulated worlds were measured.")
    return "\n".join(lines)


def _compare(world: World, resolution_m: float, rays: int) -> list[str]:
    model = SensorModel()
    ours, theirs = OctreeMap(resolution_m, model), octomap_tree(resolution_m, model)
    ours_s = theirs_s = 0.0
    beams = sum(len(scan.points_m) for scan in world.scans)
    before = heap_bytes()
    for scan in world.scans:
        begin_s = time.process_time()
        ours.insert_scan(scan.origin_m, scan.points_m, RANGE_M)
        ours_s += time.process_time() - begin_s
    between = heap_bytes()
    clouds = [(scan.points_m.astype(np.float64), scan.origin_m) for scan in world.scans]
    between_clouds = heap_bytes()
    for points, origin in clouds:
        begin_s = time.process_time()
        theirs.insertPointCloud(points, origin, RANGE_M)
        theirs_s += time.process_time() - begin_s
    mine_mb, its_mb = (between - before) / 1e6, (heap_bytes() - between_clouds) / 1e6
    differing, largest = _differences(ours, theirs, resolution_m)
    mine_us, its_us, call_us = _rays(ours, theirs, world.scans[0], rays)
    told_mb = f"{ours.memory_bytes() / 1e6:.2f}, {theirs.memoryUsage() / 1e6:.2f}"
    share = BEAMS / beams
    return [
        world.name,
        f"{resolution_m} m",
        str(differing),
        f"{largest:.0e}",
        f"{ours_s * share:.3f}, {theirs_s * share:.3f}",
        f"{theirs_s / ours_s:.1f} x",
        f"{mine_mb:.2f}, {its_mb:.2f}",
        f"{its_mb / mine_mb:.1f} x",
        told_mb,
        f"{mine_us:.2f}, {its_us:.2f}, {call_us:.2f}",
        f"{its_us / mine_us:.1f} x ({(its_us - call_us) / mine_us:.1f} x)",
    ]


class _Mallinfo2(ctypes.Structure):
    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in (
            *("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks"),
            *("uordblks", "fordblks", "keepcost"),
        )
    )


def heap_bytes() -> int:
    """Bytes that the C library has handed out and not taken back (glibc, mallinfo2)."""
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = _Mallinfo2
    found = mallinfo2()
    return int(found.uordblks + found.hblkhd)


def _differences(ours: OctreeMap, theirs: Any, resolution_m: float) -> tuple[int, float]:
    """Voxels that are known to one map only or differ in being occupied; largest difference."""
    corners, edges, values = [], [], []
    for leaf in theirs.begin_leafs():
        corners.append(leaf.getCoordinate())
        edges.append(leaf.getSize())
        values.append(leaf.getValue())
    keys, log_odds = _voxels(np.array(corners), np.array(edges), np.array(values), resolution_m)
    centres, mine = ours.known_voxels()
    my_keys = np.floor(centres / resolution_m).astype(np.int64)
    order, my_order = np.argsort(_packed(keys)), np.argsort(_packed(my_keys))
    its, my = _packed(keys)[order], _packed(my_keys)[my_order]
    only = len(np.setxor1d(its, my, assume_unique=True))
    if only:
        return only, float("inf")
    a, b = log_odds[order], mine[my_order]
    return int(((a >= 0) != (b >= 0)).sum()), float(np.abs(a - b).max())


def _voxels(
    centres: NDArray[np.float64],
    edges: NDArray[np.float64],
    values: NDArray[np.float64],
    resolution_m: float,
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Pruned leaves, written out voxel by voxel."""
    size = np.round(edges / resolution_m).astype(np.int64)
    low = np.round(centres / resolution_m - size[:, None] / 2).astype(np.int64)
    keys, log_odds = [], []
    for edge in np.unique(size):
        mine = size == edge
        offsets = np.stack(np.meshgrid(*[np.arange(edge)] * 3), axis=-1).reshape(-1, 3)
        keys.append((low[mine][:, None, :] + offsets).reshape(-1, 3))
        log_odds.append(np.repeat(values[mine], len(offsets)))
    return np.concatenate(keys), np.concatenate(log_odds)


def _packed(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    shifted = keys + 2**20
    packed: NDArray[np.int64] = shifted[:, 0] | shifted[:, 1] << 21 | shifted[:, 2] << 42
    return packed


def _rays(ours: OctreeMap, theirs: Any, scan: Scan, count: int) -> tuple[float, float, float]:
    """Microseconds a ray of our batch, of OctoMap ray by ray, and of such a call that does
    nothing."""
    beams = scan.points_m.astype(np.float64) - scan.origin_m
    directions = beams[np.random.default_rng(1).integers(len(beams), size=count)]
    directions += np.random.default_rng(2).normal(size=directions.shape) * 0.02
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    begin_s = time.process_time()
    ends, _ = ours.cast_rays(scan.origin_m, directions, RANGE_M)
    mine_s = time.process_time() - begin_s
    end = np.zeros(3)
    begin_s = time.process_time()
    hits = sum(theirs.castRay(scan.origin_m, ray, end, False, RANGE_M) for ray in directions)
    its_s = time.process_time() - begin_s
    if hits != int((ends == RayEnd.HIT).sum()):
        raise RuntimeError(f"OctoMap's rays hit {hits} times, ours {(ends == RayEnd.HIT).sum()}")
    begin_s = time.process_time()
    for ray in directions:
        theirs.castRay(scan.origin_m, ray, end, False, 1e-6)
    call_s = time.process_time() - begin_s
    return tuple(1e6 * spent_s / count for spent_s in (mine_s, its_s, call_s))  # type: ignore[return-value]
