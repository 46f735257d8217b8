"""Segmentation of a partially explored map, step by step (Wurm, section 2.4)."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semantic_attachments._core import DistanceTransform, Region
from semantic_attachments.neighbours import beside
from semantic_attachments.world import OCCUPIED_FROM
from service.coordination.frontiers import EIGHT_NEIGHBOURS
from service.coordination.segmentation.critical_points import (
    at_junctions,
    critical_points,
    local_minima,
)
from service.coordination.segmentation.graph_reduction import ReducedGraph, reduced
from service.coordination.segmentation.partition import Cut, cuts, partition
from service.coordination.segmentation.voronoi_graph import (
    SkeletonParameters,
    VoronoiGraph,
    voronoi_graph,
)

CRITERIA = ("minima", "junctions", "unknown")
"""Thrun's local minima; those beside junctions; those of them that lead into unknown space."""


@dataclass(frozen=True)
class SegmentationParameters:
    """How a map is cut.

    As measured (docs/exploration.md): furniture left out, plain local minima find more doorways
    than the thesis's constraints and put fewer cuts elsewhere. `THESIS` is section 2.4 as it is.
    """

    criterion: str = "minima"
    """One of `CRITERIA`."""
    skeleton: SkeletonParameters = field(default_factory=SkeletonParameters)
    least_wall_m: float = 3.5
    """Obstacles that extend less far are furniture and part no rooms; 0 for none [m]."""

    def __post_init__(self) -> None:
        if self.criterion not in CRITERIA:
            known = ", ".join(CRITERIA)
            raise ValueError(f"criterion {self.criterion!r} is not one of {known}")


THESIS = SegmentationParameters(criterion="unknown", least_wall_m=0.0)
"""Both constraints of section 2.4.3, all obstacles alike."""


@dataclass(frozen=True)
class Segmentation:
    """A partition and how it came about."""

    labels: NDArray[np.int32]
    """(rows, columns) number of each free cell's segment, from 1; 0 where it is not free."""
    critical: tuple[int, ...]
    """Critical points by cell, `row * columns + column`."""
    cuts: tuple[Cut, ...]
    """The line through each of them."""
    graph: VoronoiGraph
    reduced: ReducedGraph
    clearance_cells: NDArray[np.float32]
    """(rows, columns) distance to the nearest known obstacle [cells]."""


def segment(
    cells: NDArray[np.int8], resolution_m: float, parameters: SegmentationParameters | None = None
) -> Segmentation:
    """Cuts the known free space of an occupancy grid (-1 unknown, 0 free ... 100 occupied)."""
    parameters = parameters or SegmentationParameters()
    occupied = cells >= OCCUPIED_FROM
    free = (cells >= 0) & ~occupied
    if parameters.least_wall_m > 0.0:
        furniture = small_obstacles(occupied, parameters.least_wall_m / resolution_m)
        occupied &= ~furniture
        whole = _cut(free | furniture, occupied, cells < 0, resolution_m, parameters)
        return replace(whole, labels=np.where(free, whole.labels, np.int32(0)))
    return _cut(free, occupied, cells < 0, resolution_m, parameters)


def _cut(
    free: NDArray[np.bool_],
    occupied: NDArray[np.bool_],
    unknown: NDArray[np.bool_],
    resolution_m: float,
    parameters: SegmentationParameters,
) -> Segmentation:
    distances = DistanceTransform(occupied)
    graph = voronoi_graph(free, occupied, resolution_m, parameters.skeleton, distances)
    core = reduced(graph)
    match parameters.criterion:
        case "minima":
            critical = local_minima(core)
        case "junctions":
            critical = at_junctions(core)
        case _:
            critical = critical_points(core, way_to_unknown(free, unknown))
    lines = cuts(critical, distances)
    return Segmentation(
        partition(free, lines),
        critical,
        lines,
        graph,
        core,
        distances.distances(),
    )


def small_obstacles(occupied: NDArray[np.bool_], extent_cells: float) -> NDArray[np.bool_]:
    """(rows, columns) obstacles whose bounding box has a shorter diagonal."""
    labels, count = ndimage.label(occupied, EIGHT_NEIGHBOURS)
    small = np.zeros(count + 1, dtype=np.bool_)
    for number, box in enumerate(ndimage.find_objects(labels), 1):
        small[number] = np.hypot(*(side.stop - side.start for side in box)) < extent_cells
    return small[labels]


def segment_labels(
    cells: NDArray[np.int8], resolution_m: float, parameters: SegmentationParameters | None = None
) -> NDArray[np.int32]:
    """The labels of `segment` alone; looks only at the part of the grid where anything is known."""
    labels = np.zeros(cells.shape, dtype=np.int32)
    rows, columns = (
        np.flatnonzero((cells >= 0).any(axis=1)),
        np.flatnonzero((cells >= 0).any(axis=0)),
    )
    if len(rows):
        # A cell more on all sides, so that what is unknown beyond the known part stays unknown.
        window = (
            slice(max(rows[0] - 1, 0), rows[-1] + 2),
            slice(max(columns[0] - 1, 0), columns[-1] + 2),
        )
        labels[window] = segment(cells[window], resolution_m, parameters).labels
    return labels


def way_to_unknown(free: NDArray[np.bool_], unknown: NDArray[np.bool_]) -> NDArray[np.float32]:
    """(rows, columns) length of the way through free space to the nearest unknown cell [cells]."""
    border = np.flatnonzero((free & beside(unknown)).ravel())
    return Region(free).geodesic(border.astype(np.uint32)).lengths()
