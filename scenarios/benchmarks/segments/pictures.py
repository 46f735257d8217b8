"""Pictures of a segmentation: distances, graph, critical points, segments, assignment."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from scenarios.exploration.buildings import Building
from scenarios.exploration.one_run import explore
from scenarios.exploration.planner_per_cluster import PlannerPerCluster
from service.coordination.exploration.segment_assignment import SegmentAssignment
from service.coordination.exploration.strategy import Exploring
from service.coordination.segmentation.segmentation import Segmentation, segment
from simulator.kinematic_exploration import Decide, Errand, TeamView

SCALE = 6
"""pixels a cell"""
UNKNOWN, WALL, FREE = (176, 196, 214), (20, 20, 20), (255, 255, 255)
Colours = NDArray[np.uint8]


class Moment:
    """The view and the errands of a decision in the middle of an exploration."""

    def __init__(self, at_work: PlannerPerCluster, time_s: float) -> None:
        self._at_work, self._time_s = at_work, time_s
        self.view: TeamView | None = None
        self.errands: dict[str, Errand] = {}

    def __call__(self, view: TeamView) -> dict[str, Errand]:
        errands = dict(self._at_work(view))
        if self.view is None and view.time_s >= self._time_s and errands:
            self.view, self.errands = view, errands
        return errands


def draw_pictures(building: Building, robots: int, time_s: float, folder: Path) -> list[Path]:
    """Writes five PNG files of one decision of the segments strategy.

    Raises:
        ValueError: the exploration was over before that time.
    """
    caught: list[Moment] = []

    def watched(at_work: PlannerPerCluster) -> Decide:
        caught.append(Moment(at_work, time_s))
        return caught[0]

    explore(building, robots, 1, Exploring(SegmentAssignment(), "segments"), watched=watched)
    moment = caught[0]
    if moment.view is None:
        raise ValueError(f"{building.name} is explored before {time_s:g} s")
    grid = moment.view.grid
    found = segment(grid.cells, grid.resolution_m)
    folder.mkdir(parents=True, exist_ok=True)
    pictures = {
        "1_distance_transform": _distances(grid.cells, found),
        "2_voronoi_graph": _graph(grid.cells, found, critical=False),
        "3_critical_points": _graph(grid.cells, found, critical=True),
        "4_segments": _segments(grid.cells, found),
        "5_assignment": _assignment(grid.cells, found, moment, grid.resolution_m),
    }
    paths = []
    for name, picture in pictures.items():
        path = folder / f"{building.name}_{name}.png"
        _cropped(picture, grid.cells).save(path, optimize=True)
        paths.append(path)
    return paths


def _base(cells: NDArray[np.int8]) -> Colours:
    colours = np.empty((*cells.shape, 3), dtype=np.uint8)
    colours[:] = FREE
    colours[cells < 0] = UNKNOWN
    colours[cells >= 50] = WALL
    return colours


def _enlarged(colours: Colours) -> Image.Image:
    """Row 0 at the bottom."""
    height, width = colours.shape[:2]
    image = Image.fromarray(np.ascontiguousarray(colours[::-1]))
    return image.resize((SCALE * width, SCALE * height), Image.Resampling.NEAREST)


def _distances(cells: NDArray[np.int8], found: Segmentation) -> Image.Image:
    colours = _base(cells)
    free = (cells >= 0) & (cells < 50)
    widest = float(found.clearance_cells[free].max(initial=1.0))
    shade = 255.0 - 215.0 * found.clearance_cells / widest
    colours[free] = shade[free, None].astype(np.uint8)
    return _enlarged(colours)


def _graph(cells: NDArray[np.int8], found: Segmentation, *, critical: bool) -> Image.Image:
    image = _enlarged(_base(cells))
    draw = ImageDraw.Draw(image)
    at = _places(cells)
    if not critical:
        for cell in found.graph.cells.tolist():
            _dot(draw, at(cell), 1.5, (150, 150, 150))
    for cell, joined in found.reduced.neighbours.items():
        for other in joined:
            if cell < other:
                draw.line([at(cell), at(other)], fill=(46, 139, 87), width=2)
    for cell in found.reduced.neighbours:
        _dot(draw, at(cell), 3, (30, 60, 200))
    if critical:
        for cell in found.critical:
            _dot(draw, at(cell), 6, (220, 30, 30))
    return image


def _segments(cells: NDArray[np.int8], found: Segmentation) -> Image.Image:
    colours = _base(cells)
    random = np.random.default_rng(3)
    palette = random.integers(150, 250, (int(found.labels.max()) + 1, 3)).astype(np.uint8)
    inside = found.labels > 0
    colours[inside] = palette[found.labels[inside]]
    image = _enlarged(colours)
    draw = ImageDraw.Draw(image)
    columns = cells.shape[1]
    at = _places(cells)
    for line in found.cuts:
        draw.line([at(row * columns + column) for row, column in line], fill=(200, 0, 0), width=3)
    return image


def _assignment(
    cells: NDArray[np.int8], found: Segmentation, moment: Moment, resolution_m: float
) -> Image.Image:
    image = _segments(cells, found)
    draw = ImageDraw.Draw(image)
    height = cells.shape[0] * SCALE

    def at(x: float, y: float) -> tuple[float, float]:
        return x / resolution_m * SCALE, height - y / resolution_m * SCALE

    for robot, errand in moment.errands.items():
        path = [at(float(x), float(y)) for x, y in errand.path_m]
        draw.line(path, fill=(20, 20, 120), width=3)
        _dot(draw, path[-1], 7, (255, 140, 0))
        _dot(draw, path[0], 8, (20, 20, 120))
        draw.text((path[0][0] - 3, path[0][1] - 6), robot[-1], fill=(255, 255, 255))
    return image


def _places(cells: NDArray[np.int8]) -> Callable[[int], tuple[float, float]]:
    rows, columns = cells.shape

    def at(cell: int) -> tuple[float, float]:
        row, column = divmod(cell, columns)
        return (column + 0.5) * SCALE, (rows - row - 0.5) * SCALE

    return at


def _dot(
    draw: ImageDraw.ImageDraw, at: tuple[float, float], radius: float, fill: tuple[int, int, int]
) -> None:
    x, y = at
    draw.ellipse([x - radius, y - radius, x + radius, y + radius], fill=fill)


def _cropped(image: Image.Image, cells: NDArray[np.int8]) -> Image.Image:
    """The part where anything is known."""
    rows, columns = np.nonzero(cells >= 0)
    top = (cells.shape[0] - rows.max() - 3) * SCALE
    bottom = (cells.shape[0] - rows.min() + 2) * SCALE
    box = ((columns.min() - 2) * SCALE, top, (columns.max() + 3) * SCALE, bottom)
    left, upper, right, lower = box
    return image.crop(
        (max(left, 0), max(upper, 0), min(right, image.width), min(lower, image.height))
    )
