"""Hierarchies of maps against one map of everything (Wurm, figures 5.19 to 5.22)."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.benchmarks.mapping.figures import figure, table
from simulator.mapping.hierarchy import MapHierarchy, Segment
from simulator.mapping.octree import MapFullError, OctreeMap
from simulator.mapping.pictures import View, isometric_picture
from simulator.mapping.scene import Box, Cup, DepthSensor, Scene, Solid, tabletop_scene
from simulator.mapping.tabletop import TabletopParameters, segment, tabletop_hierarchy
from simulator.mapping.viewpoints import Viewpoint, look_at

Points = NDArray[np.float32]
LIMIT_BYTES = 5 * 10**8
NEAR_M = (np.array([-0.65, -0.45, 0.70]), np.array([0.65, 0.45, 1.1]))
"""The table and what stands on it."""


def big_objects() -> Scene:
    """The room of `tabletop_scene` with three large objects."""
    room = tabletop_scene(objects=0)
    large: list[Solid] = [
        Box((-0.3, 0.05, 0.87), (0.3, 0.2, 0.24), 0.3),
        Cup((0.1, -0.15, 0.75), 0.11, 0.28),
        Box((0.38, 0.15, 0.85), (0.2, 0.16, 0.2), 0.9),
    ]
    return Scene((*room.solids, *large))


def views(count: int, distance_m: float = 1.3) -> list[Viewpoint]:
    """A sweep along one side of the table and around its corners."""
    bearings = np.linspace(-0.75 * np.pi, -0.25 * np.pi, count)
    return [
        look_at((distance_m * float(np.cos(b)), distance_m * float(np.sin(b))), 1.35, (0, 0, 0.75))
        for b in bearings
    ]


def measure(quick: bool, out: Path) -> str:
    """Memory and time at 1 to 16 mm, then objects that come, hide one another and go."""
    sensor = DepthSensor(
        columns=240 if quick else 400,
        rows=180 if quick else 300,
        horizontal_field_rad=0.9,
        vertical_field_rad=0.7,
        range_m=2.0,
    )
    count = 5 if quick else 8
    resolutions_mm = (16, 8, 4) if quick else (16, 8, 4, 2, 1)
    rows = [
        [
            "objects",
            "voxel of objects",
            "one map [MB]",
            "hierarchy [MB]",
            "smaller",
            "one map [CPU s]",
            "hierarchy [CPU s]",
            "faster",
            "faster with segmentation",
        ]
    ]
    curves = {}
    for name, scene in (("small", tabletop_scene(objects=6, seed=2)), ("big", big_objects())):
        clouds = [
            (np.array(v.position_m), sensor.measure(scene, v.position_m, v.yaw_rad, v.pitch_rad))
            for v in views(count)
        ]
        begin_s = time.process_time()
        cut = [segment(points, _PARAMETERS, seed=i) for i, (_, points) in enumerate(clouds)]
        cutting_s = time.process_time() - begin_s
        curves[name] = [_compare(clouds, cut, mm / 1000) for mm in resolutions_mm]
        for mm, (whole, parts) in zip(resolutions_mm, curves[name], strict=True):
            rows.append([name, f"{mm} mm", *_told(whole, parts, cutting_s)])
        if name == "small":
            fine = _hierarchy(clouds, cut, 0.004 if quick else 0.002)[0]
            isometric_picture(as_one(fine, 0.004), View(width_px=700), NEAR_M).save(
                out / "tabletop.png"
            )
    _draw(resolutions_mm, curves, out)
    return (
        f"{table(rows)}\n\n{count} views of {sensor.columns} x {sensor.rows} beams, range 2 m; the "
        "table at 10 mm, the background at 50 mm; objects are clusters at 15 mm, as the rows of "
        "beams are 11 mm apart on faces seen at a slant; one map of everything at the voxel size "
        f"of the objects, refused above {LIMIT_BYTES / 1e6:.0f} MB.\n\n"
        "![Memory and time of hierarchies](tables.svg)\n\n"
        "![The small objects in the hierarchy](tabletop.png)\n\n"
        f"{_vanishing(sensor, out)}"
    )


_PARAMETERS = TabletopParameters(cluster_distance_m=0.015)
Cost = tuple[int, float]
"""Bytes and CPU seconds."""


def _compare(
    clouds: list[tuple[NDArray[np.float64], Points]], cut: list[list[Segment]], resolution_m: float
) -> tuple[Cost | None, Cost]:
    whole = OctreeMap(resolution_m, memory_limit_bytes=LIMIT_BYTES)
    begin_s = time.process_time()
    cost: Cost | None = None
    try:
        for origin, points in clouds:
            whole.insert_scan(origin, points)
        cost = (whole.memory_bytes(), time.process_time() - begin_s)
    except MapFullError:
        pass
    hierarchy, spent_s = _hierarchy(clouds, cut, resolution_m)
    return cost, (hierarchy.memory_bytes(), spent_s)


def _hierarchy(
    clouds: list[tuple[NDArray[np.float64], Points]], cut: list[list[Segment]], resolution_m: float
) -> tuple[MapHierarchy, float]:
    hierarchy = tabletop_hierarchy({"background": 0.05, "table": 0.01, "object": resolution_m})
    begin_s = time.process_time()
    for (origin, _), parts in zip(clouds, cut, strict=True):
        hierarchy.update(parts, origin)
    return hierarchy, time.process_time() - begin_s


def _told(whole: Cost | None, parts: Cost, cutting_s: float) -> list[str]:
    mine = f"{parts[0] / 1e6:.2f}"
    if whole is None:
        return ["refused", mine, "", "", f"{parts[1]:.2f}", "", ""]
    return [
        f"{whole[0] / 1e6:.1f}",
        mine,
        f"{whole[0] / parts[0]:.0f} x",
        f"{whole[1]:.2f}",
        f"{parts[1]:.2f}",
        f"{whole[1] / parts[1]:.0f} x",
        f"{whole[1] / (parts[1] + cutting_s):.1f} x",
    ]


def as_one(hierarchy: MapHierarchy, resolution_m: float) -> OctreeMap:
    """The occupied voxels of tables and objects in one map of the map frame, to look at."""
    whole = OctreeMap(resolution_m)
    for node in hierarchy.nodes():
        if node.label == "background":
            continue
        pose = node.T_map_node
        # A coarse voxel is filled, not dotted.
        steps = 1 + int(np.ceil(node.map.resolution_m / resolution_m))
        grid = (np.arange(steps) + 0.5) / steps - 0.5
        offsets = np.stack(np.meshgrid(*[grid] * 3), axis=-1).reshape(-1, 3)
        inside = ([-1.5] * 3, [1.5] * 3)
        centres = node.map.occupied_voxels(inside)
        local = (centres[:, None] + offsets * node.map.resolution_m).reshape(-1, 3)
        points = local @ pose[:3, :3].T + pose[:3, 3]
        near = ((points > NEAR_M[0]) & (points < NEAR_M[1])).all(axis=1)
        whole.set_log_odds(points[near], np.ones(int(near.sum())))
    return whole


def _vanishing(sensor: DepthSensor, out: Path) -> str:
    """A box, then a tube before it, then the box is gone: what is left of it after each view."""
    room = tabletop_scene(objects=0).solids
    supply = Box((0.05, 0.0, 0.80), (0.14, 0.22, 0.10))
    tube = Cup((-0.14, 0.02, 0.75), 0.06, 0.22, closed=True)
    scenes = [Scene((*room, supply)), Scene((*room, supply, tube))]
    scenes += [Scene((*room, tube))] * 6
    view = look_at((-1.1, 0.0), 1.15, (0.0, 0.0, 0.8))
    origin = np.array(view.position_m)
    whole = OctreeMap(0.002)
    hierarchy = tabletop_hierarchy({"background": 0.05, "table": 0.01, "object": 0.002})
    place = ([-0.02, -0.12, 0.765], [0.13, 0.12, 0.86])
    rows = [["view", "on the table", "voxels of the box in one map", "objects in the hierarchy"]]
    for number, scene in enumerate(scenes):
        points = sensor.measure(scene, view.position_m, view.yaw_rad, view.pitch_rad)
        whole.insert_scan(origin, points)
        hierarchy.update(segment(points, _PARAMETERS, seed=number), origin)
        objects = [node for node in hierarchy.nodes() if node.label == "object"]
        stands = ("box", "box, tube", *["tube"] * 6)[number]
        left = f"{len(whole.occupied_voxels(place)):,}"
        told = ", ".join(f"P = {node.existence:.2f}" for node in objects)
        rows.append([str(number + 1), stands, left, f"{len(objects)} ({told})"])
    upright = View(azimuth_rad=-2.4, width_px=500)
    near = (np.array([-0.3, -0.25, 0.73]), np.array([0.3, 0.25, 1.0]))
    coarse = OctreeMap(0.004)
    seen = whole.occupied_voxels(near)
    coarse.set_log_odds(seen, np.ones(len(seen)))
    isometric_picture(coarse, upright, near).save(out / "vanished_one_map.png")
    isometric_picture(as_one(hierarchy, 0.004), upright, near).save(out / "vanished_hierarchy.png")
    return (
        f"{table(rows)}\n\nOne view point, 2 mm. Left the one map with the ghost behind the tube, "
        "right the hierarchy.\n\n"
        "![One map](vanished_one_map.png) ![Hierarchy](vanished_hierarchy.png)"
    )


def _draw(
    resolutions_mm: tuple[int, ...],
    curves: dict[str, list[tuple[Cost | None, Cost]]],
    out: Path,
) -> None:
    with figure(out / "tables.svg", panels=2) as axes:
        for axis, unit, index, scale in (
            (axes[0], "memory [MB]", 0, 1e6),
            (axes[1], "time [CPU s]", 1, 1.0),
        ):
            for colour, (name, points) in enumerate(curves.items()):
                pairs = list(zip(resolutions_mm, points, strict=True))
                whole = [(mm, cost[index] / scale) for mm, (cost, _) in pairs if cost is not None]
                parts = [(mm, cost[index] / scale) for mm, (_, cost) in pairs]
                axis.plot(*np.array(whole).T, f"C{colour}x--", label=f"{name} objects, one map")
                axis.plot(*np.array(parts).T, f"C{colour}o-", label=f"{name} objects, hierarchy")
            axis.set(xscale="log", yscale="log", xlabel="voxel of objects [mm]", ylabel=unit)
            axis.set_xticks(resolutions_mm, [str(mm) for mm in resolutions_mm])
            axis.set_xticks([], minor=True)
        axes[0].legend(frameon=False, fontsize=7)
