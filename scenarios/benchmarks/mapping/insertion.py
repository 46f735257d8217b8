"""CPU time of 100,000 beams against voxel size (Wurm, figure 5.17)."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from scenarios.benchmarks.mapping.figures import figure, table
from scenarios.benchmarks.mapping.octomap_peer import octomap_tree
from scenarios.benchmarks.mapping.worlds import World, building_079, campus, corridor
from simulator.mapping.octree import OctreeMap, SensorModel

BEAMS = 100_000


def measure(quick: bool, out: Path) -> str:
    """Two scans in ours and in OctoMap, which is left out where it would take minutes."""
    indoors = building_079(BEAMS, 9) or corridor(BEAMS, 9)
    indoors = World(indoors.name, indoors.extent_m, indoors.scans[1:3])
    outdoors = campus(scans=9)
    outdoors = World(outdoors.name, outdoors.extent_m, outdoors.scans[4:6])
    cases = [(indoors, 10.0), (outdoors, 10.0), (outdoors, 50.0)]
    resolutions = [0.8, 0.4, 0.2, 0.1] if quick else [0.8, 0.4, 0.2, 0.1, 0.05]
    rows = [["world, range", "voxel", "ours [s]", "OctoMap [s]", "faster"]]
    curves: dict[str, list[tuple[float, float, float | None]]] = {}
    for world, range_m in cases:
        name = f"{world.name}, {range_m:.0f} m"
        curves[name] = []
        for resolution_m in resolutions:
            ours_s = _ours_s(world, resolution_m, range_m)
            theirs_s = _theirs_s(world, resolution_m, range_m) if ours_s < 2.0 else None
            curves[name].append((resolution_m, ours_s, theirs_s))
            told = (
                ("-", "-")
                if theirs_s is None
                else (f"{theirs_s:.3f}", f"{theirs_s / ours_s:.1f} x")
            )
            rows.append([name, f"{resolution_m} m", f"{ours_s:.3f}", *told])
    with figure(out / "insertion.svg", width_in=6.0) as axis:
        for number, (name, points) in enumerate(curves.items()):
            axis.plot([p[0] for p in points], [p[1] for p in points], f"C{number}o-", label=name)
            theirs = [(p[0], p[2]) for p in points if p[2] is not None]
            axis.plot(*np.array(theirs).T, f"C{number}x--", label=f"{name}, OctoMap")
        axis.set(xscale="log", yscale="log", xlabel="voxel [m]", ylabel="CPU s for 100,000 beams")
        axis.set_xticks(resolutions, [str(r) for r in resolutions])
        axis.set_xticks([], minor=True)
        axis.legend(frameon=False, fontsize=7)
    return f"{table(rows)}\n\nOne thread.\n\n![CPU time of insertion](insertion.svg)"


def _ours_s(world: World, resolution_m: float, range_m: float) -> float:
    octree, beams = OctreeMap(resolution_m), 0
    begin_s = time.process_time()
    for scan in world.scans:
        octree.insert_scan(scan.origin_m, scan.points_m, range_m)
        beams += len(scan.points_m)
    return (time.process_time() - begin_s) * BEAMS / beams


def _theirs_s(world: World, resolution_m: float, range_m: float) -> float:
    tree = octomap_tree(resolution_m, SensorModel())
    spent_s, beams = 0.0, 0
    for scan in world.scans:
        points = scan.points_m.astype(np.float64)
        begin_s = time.process_time()
        tree.insertPointCloud(points, scan.origin_m, range_m)
        spent_s += time.process_time() - begin_s
        beams += len(points)
    return spent_s * BEAMS / beams
