"""The map of a mission as SVG: building, trails, targets, blockades.

The drawing's unit is the metre; y points down in SVG, so it is turned over.
"""

from __future__ import annotations

from collections.abc import Callable
from html import escape

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.floor_plan import FREE, OCCUPIED, Point
from scenarios.mission_record import BlockadeRecord, MissionRecord, TargetRecord
from scenarios.report.markup import clock, element, title

SPLIT_TRAIL_M = 0.25
"""a trail is drawn through points at least this far apart"""


def map_figure(
    record: MissionRecord, cells: NDArray[np.int8], resolution_m: float, origin_m: Point
) -> str:
    """SVG of the map `(height, width)` and what happened on it."""
    height_m, width_m = cells.shape[0] * resolution_m, cells.shape[1] * resolution_m
    scale = max(width_m, height_m) / 120

    def at(point: Point) -> Point:
        return round(point[0] - origin_m[0], 2), round(height_m - (point[1] - origin_m[1]), 2)

    layers = [
        element("path", class_="floor", d=runs(cells == FREE, resolution_m)),
        element("path", class_="wall", d=runs(cells == OCCUPIED, resolution_m)),
        *(_trail(record, k, at) for k in range(len(record.robots))),
        *(_blockade(blockade, at, scale) for blockade in record.blockades),
        *(_target(target, record, at, scale) for target in record.targets),
        *(_robot(record, k, at, scale) for k in range(len(record.robots))),
    ]
    return element(
        "svg",
        "".join(layers),
        class_="map",
        viewBox=f"0 0 {width_m:g} {height_m:g}",
        role="img",
        aria_label=f"Map of {record.scenario} with driven paths",
    )


def runs(mask: NDArray[np.bool_], cell_m: float) -> str:
    """Path data that fills the true cells; equal runs of neighbouring rows make one rectangle."""
    height = mask.shape[0]
    pieces: list[str] = []
    begun: dict[tuple[int, int], int] = {}
    for row in range(height + 1):
        here: set[tuple[int, int]] = set()
        if row < height:
            edges = np.flatnonzero(np.diff(np.pad(mask[row].astype(np.int8), 1)))
            here = {(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)}
        for run in sorted(begun.keys() - here):
            first = begun.pop(run)
            x, y = run[0] * cell_m, (height - row) * cell_m
            wide, high = (run[1] - run[0]) * cell_m, (row - first) * cell_m
            pieces.append(f"M{x:g} {y:g}h{wide:g}v{high:g}h{-wide:g}z")
        for run in here - begun.keys():
            begun[run] = row
    return "".join(pieces)


def _trail(record: MissionRecord, index: int, at: Callable[[Point], Point]) -> str:
    robot = record.robots[index]
    points = " ".join(f"{x:g},{y:g}" for x, y in (at((x, y)) for _, x, y in thinned(robot.trail)))
    return element(
        "polyline",
        title(f"{robot.id}: {robot.distance_m:.0f} m"),
        class_=f"trail robot-{index % 8}",
        data_robot=index,
        points=points,
    )


def thinned(
    trail: tuple[tuple[float, float, float], ...],
) -> list[tuple[float, float, float]]:
    """The samples of a trail that are a visible distance apart, and its last one."""
    kept: list[tuple[float, float, float]] = []
    for sample in trail:
        if not kept or np.hypot(sample[1] - kept[-1][1], sample[2] - kept[-1][2]) >= SPLIT_TRAIL_M:
            kept.append(sample)
    if trail and kept[-1] != trail[-1]:
        kept.append(trail[-1])
    return kept


def _robot(record: MissionRecord, index: int, at: Callable[[Point], Point], scale: float) -> str:
    robot = record.robots[index]
    if not robot.trail:
        return ""
    x0, y0 = at(robot.trail[0][1:])
    x, y = at(robot.trail[-1][1:])
    start = element(
        "rect",
        title(f"{robot.id} starts here"),
        class_=f"start robot-{index % 8}",
        x=x0 - 0.7 * scale,
        y=y0 - 0.7 * scale,
        width=1.4 * scale,
        height=1.4 * scale,
    )
    shape = element("circle", title(robot.id), r=0.95 * scale, class_=f"body robot-{index % 8}")
    letter = element(
        "text", escape(short(robot.id)), class_="body-text", y=0.36 * scale, font_size=1.05 * scale
    )
    return start + element(
        "g", shape + letter, class_="robot", data_robot=index, transform=f"translate({x:g} {y:g})"
    )


def _target(
    target: TargetRecord, record: MissionRecord, at: Callable[[Point], Point], scale: float
) -> str:
    x, y = at(target.position_m)
    names = [robot.id for robot in record.robots]
    visited = target.visited_by is not None and target.visited_by in names
    colour = f" robot-{names.index(target.visited_by or '') % 8}" if visited else ""
    text = f"{target.id}: not visited"
    if target.visited_at_s is not None:
        text = f"{target.id}: visited by {target.visited_by} at {clock(target.visited_at_s)}"
    ring = element("circle", title(text), r=1.15 * scale)
    number = element("text", escape(short(target.id)), y=0.42 * scale, font_size=1.2 * scale)
    return element(
        "g",
        ring + number,
        class_=f"target{' visited' if visited else ''}{colour}",
        data_visited=target.visited_at_s,
        transform=f"translate({x:g} {y:g})",
    )


def _blockade(blockade: BlockadeRecord, at: Callable[[Point], Point], scale: float) -> str:
    (x0, y0), (x1, y1) = (at(point) for point in blockade.segment_m)
    state, text = "unseen", f"{blockade.id}: never seen"
    if blockade.seen_at_s is not None:
        state, text = "seen", f"{blockade.id}: seen at {clock(blockade.seen_at_s)}, not cleared"
    if blockade.cleared_at_s is not None:
        state = "cleared"
        text = (
            f"{blockade.id}: seen at {clock(blockade.seen_at_s)}, "
            f"cleared by {blockade.cleared_by} at {clock(blockade.cleared_at_s)}"
        )
    return element(
        "line",
        title(text),
        class_=f"blockade {state}",
        data_seen=blockade.seen_at_s,
        data_cleared=blockade.cleared_at_s,
        x1=x0,
        y1=y0,
        x2=x1,
        y2=y1,
        stroke_width=0.8 * scale,
    )


def short(name: str) -> str:
    """`explorer_2` -> `e2`, `target_12` -> `12`: what fits into a symbol."""
    word, _, number = name.rpartition("_")
    if not word:
        return name[:3]
    return number if word == "target" else word[0] + number
