"""Memory and file sizes: full grid, octree, compressed octree (Wurm, table 5.2, figure 5.16)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenarios.benchmarks.mapping.figures import figure, table
from scenarios.benchmarks.mapping.octomap_peer import INNER_BYTES, LEAF_BYTES
from scenarios.benchmarks.mapping.worlds import (
    World,
    building_079,
    campus,
    corridor,
    small_room,
    tilt_scan,
)
from simulator.mapping.octree import OctreeMap

BRICK_VOXELS = 512
BUCKET_BYTES = 25
"""Of a brick's place in our hash table."""


@dataclass(frozen=True)
class Sizes:
    """What one map takes, each way of holding it [bytes]."""

    grid: int
    octree: int
    octree_pruned: int
    bricks: int
    bricks_collapsed: int
    file_all: int
    file_binary: int
    voxels: int


def sizes(octree: OctreeMap) -> Sizes:
    """Measures a map; OctoMap's octree follows from its numbers of nodes, which equal ours."""
    centres, _ = octree.known_voxels()
    extent = np.round(np.ptp(centres, axis=0) / octree.resolution_m).astype(np.int64) + 1
    leaves, inner = octree.unpruned_counts()
    pruned_leaves = len(octree.leaves()[1])
    pruned_inner = octree.node_count() - pruned_leaves
    bricks, dense = octree.brick_counts()
    return Sizes(
        grid=4 * int(extent.prod()),
        octree=leaves * LEAF_BYTES + inner * INNER_BYTES,
        octree_pruned=pruned_leaves * LEAF_BYTES + pruned_inner * INNER_BYTES,
        bricks=octree.memory_bytes() + (bricks - dense) * BRICK_VOXELS,
        bricks_collapsed=octree.memory_bytes(),
        file_all=len(octree.to_bytes(".ot")),
        file_binary=len(octree.to_bytes(".bt")),
        voxels=leaves,
    )


def measure(quick: bool, out: Path) -> str:
    """Table 5.2 on the worlds at hand, and the two parts of figure 5.16."""
    few = 3 if quick else 33
    experiments: list[tuple[World | None, float, float | None]] = [
        (small_room(scans=few), 0.05, 10.0),
        (building_079(scans=few), 0.05, 10.0),
        (building_079(scans=few), 0.1, 10.0),
        (corridor(scans=few), 0.05, 10.0),
        (corridor(scans=few), 0.1, 10.0),
        (tilt_scan(), 0.05, 10.0),
    ]
    rows = [
        [
            "world",
            "voxel",
            "full grid of floats",
            "octree",
            "octree, pruned",
            "saved",
            "bricks",
            "bricks, collapsed",
            "grid / ours",
            "octree, pruned / ours",
            "bytes a known voxel",
            "`.ot`",
            "`.bt`",
            "`.ot` / `.bt`",
        ]
    ]
    for world, resolution_m, range_m in experiments:
        if world is not None:
            rows.append(_row(world, resolution_m, sizes(mapped(world, resolution_m, range_m))))
    outdoors = campus(scans=9 if quick else 27)
    growth: dict[float, Sizes] = {}
    for resolution_m in (0.8, 0.4) if quick else (1.6, 0.8, 0.4, 0.2):
        growth[resolution_m] = sizes(mapped(outdoors, resolution_m, 80.0))
    rows += [_row(outdoors, resolution_m, growth[resolution_m]) for resolution_m in growth]
    _draw_growth(growth, _revisits(few), out)
    notes = (
        "MB = 10^6 bytes. The octree is OctoMap's: its numbers of nodes, which equal ours (held by "
        f"a test), times its {LEAF_BYTES} bytes a leaf and {INNER_BYTES} bytes an inner node on 64 "
        "bits. Bricks are ours. Range 10 m indoors, 80 m outdoors."
    )
    return f"{table(rows)}\n\n{notes}\n\n![Growth of memory](memory.svg)"


def mapped(world: World, resolution_m: float, range_m: float | None) -> OctreeMap:
    """All scans of a world in one map."""
    octree = OctreeMap(resolution_m)
    for scan in world.scans:
        octree.insert_scan(scan.origin_m, scan.points_m, range_m)
    return octree


def _row(world: World, resolution_m: float, found: Sizes) -> list[str]:
    def mb(size: int) -> str:
        return f"{size / 1e6:.2f}"

    return [
        f"{world.name}, {len(world.scans)} scans",
        f"{resolution_m} m",
        mb(found.grid),
        mb(found.octree),
        mb(found.octree_pruned),
        f"{100 * (1 - found.octree_pruned / found.octree):.0f} %",
        mb(found.bricks),
        mb(found.bricks_collapsed),
        f"{found.grid / found.bricks_collapsed:.1f}",
        f"{found.octree_pruned / found.bricks_collapsed:.1f}",
        f"{found.bricks_collapsed / found.voxels:.2f}",
        mb(found.file_all),
        mb(found.file_binary),
        f"{found.file_all / found.file_binary:.0f}",
    ]


def _revisits(scans: int) -> tuple[str, list[tuple[float, float, float]]]:
    """Memory after each scan of a corridor that is walked three times [MB]: ours, octree pruned,
    octree."""
    world = building_079(beams=30_000, scans=scans) or corridor(beams=30_000, scans=scans)
    octree, course = OctreeMap(0.05), []
    for scan in world.scans:
        octree.insert_scan(scan.origin_m, scan.points_m, 10.0)
        found = sizes(octree)
        course.append((found.bricks_collapsed / 1e6, found.octree_pruned / 1e6, found.octree / 1e6))
    return world.name, course


def _draw_growth(
    growth: dict[float, Sizes],
    revisits: tuple[str, list[tuple[float, float, float]]],
    out: Path,
) -> None:
    with figure(out / "memory.svg", panels=2) as (left, right):
        resolutions = list(growth)
        for label, series in (
            ("full grid of floats", [growth[r].grid for r in resolutions]),
            ("octree", [growth[r].octree for r in resolutions]),
            ("octree, pruned", [growth[r].octree_pruned for r in resolutions]),
            ("bricks, collapsed", [growth[r].bricks_collapsed for r in resolutions]),
        ):
            left.plot(resolutions, [size / 1e6 for size in series], marker="o", label=label)
        left.set(xscale="log", yscale="log", xlabel="voxel [m]", ylabel="memory [MB]")
        left.set_xticks(resolutions, [str(r) for r in resolutions])
        left.set_xticks([], minor=True)
        left.set_title("simulated campus")
        left.legend(frameon=False)
        name, course = revisits
        for number, label in ((2, "octree"), (1, "octree, pruned"), (0, "bricks, collapsed")):
            right.plot(range(1, len(course) + 1), [step[number] for step in course], label=label)
        right.set(xlabel="scans", ylabel="memory [MB]", ylim=(0, None))
        right.set_title(f"{name}, 0.05 m, walked three times")
        right.legend(frameon=False)
