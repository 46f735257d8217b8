"""3D models for tabletop manipulation: segmentation, labels, relation and association (Wurm,
section 5.3.4)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from simulator.mapping.hierarchy import MapHierarchy, MapNode, Segment
from simulator.mapping.octree import SensorModel
from simulator.mapping.oriented_box import OrientedBox

Points = NDArray[np.float32]

RESOLUTIONS_M: Mapping[str, float] = {"background": 0.05, "table": 0.01, "object": 0.002}
"""Voxel sizes of section 5.5.5."""


@dataclass(frozen=True, slots=True)
class TabletopParameters:
    """How a measurement is segmented (eq. 5.20)."""

    lowest_m: float = 0.5
    """Tables are horizontal planes above this height of the map frame."""
    highest_m: float = 1.0
    """And below this one."""
    plane_tolerance_m: float = 0.01
    """Distance from a plane up to which a point belongs to it."""
    largest_tilt_rad: float = 0.1
    """How far from horizontal a table may be."""
    smallest_table: int = 2000
    """Points a table has at least."""
    smallest_interior: int = 20
    """Cells of 0.05 m that a table has with all four neighbours: bands across walls have none."""
    ransac_trials: int = 300
    cluster_distance_m: float = 0.01
    """Points nearer than this belong to the same object."""
    smallest_object: int = 50
    """Points an object has at least; fewer are background."""
    object_height_m: float = 0.5
    """Objects lie between the table and this far above it."""


@dataclass(frozen=True, slots=True)
class Plane:
    """Points `p` with `normal @ p == offset_m`; the normal points up."""

    normal: NDArray[np.float64]
    offset_m: float

    def height_m(self, points_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """Signed distance `(n,)` above the plane."""
        height: NDArray[np.float64] = np.asarray(points_m, np.float64) @ self.normal - self.offset_m
        return height


def segment(points_m: Points, parameters: TabletopParameters, seed: int = 0) -> list[Segment]:
    """Tables, the objects on them and the background of a measurement `(n, 3)`, map frame (S', eq.
    5.20).

    Labels are those of L' (eq. 5.21): `background`, `table`, `object`.
    """
    random = np.random.default_rng(seed)
    remaining = np.ones(len(points_m), dtype=bool)
    tables: list[Segment] = []
    objects: list[Segment] = []
    may_be_table = remaining.copy()
    while True:
        candidates = np.flatnonzero(
            remaining
            & may_be_table
            & (points_m[:, 2] > parameters.lowest_m)
            & (points_m[:, 2] < parameters.highest_m)
        )
        plane = find_table(points_m[candidates], parameters, random)
        if plane is None:
            break
        height_m = plane.height_m(points_m)
        surface = np.flatnonzero(
            remaining & may_be_table & (np.abs(height_m) <= parameters.plane_tolerance_m)
        )
        patch, interior = _largest_patch(points_m[surface])
        surface = surface[patch]
        if len(surface) < parameters.smallest_table:
            break
        if interior < parameters.smallest_interior:
            may_be_table[surface] = False
            continue
        remaining[surface] = False
        tables.append(Segment("table", points_m[surface]))
        above = np.flatnonzero(
            remaining
            & (height_m > parameters.plane_tolerance_m)
            & (height_m < parameters.object_height_m)
        )
        above = above[_over(points_m[surface], points_m[above])]
        for cluster in clusters(points_m[above], parameters.cluster_distance_m):
            if len(cluster) >= parameters.smallest_object:
                objects.append(Segment("object", points_m[above[cluster]]))
                remaining[above[cluster]] = False
    background = [Segment("background", points_m[remaining])] if remaining.any() else []
    return [*background, *tables, *objects]


def find_table(
    points_m: Points, parameters: TabletopParameters, random: np.random.Generator
) -> Plane | None:
    """The horizontal plane with most points, by RANSAC (Fischler and Bolles, 1981), refined on its
    inliers."""
    if len(points_m) < max(3, parameters.smallest_table):
        return None
    points = points_m.astype(np.float64)
    # Trials are counted on a sample: the plane is the same and large clouds cost no more than small
    # ones.
    sample = points[random.choice(len(points), min(len(points), 5000), replace=False)]
    best, most = None, 0
    for a, b, c in sample[random.integers(len(sample), size=(parameters.ransac_trials, 3))]:
        plane = _plane_through(a, b, c)
        if plane is None or plane.normal[2] < np.cos(parameters.largest_tilt_rad):
            continue
        count = int((np.abs(plane.height_m(sample)) <= parameters.plane_tolerance_m).sum())
        if count > most:
            best, most = plane, count
    if best is None:
        return None
    inliers = points[np.abs(best.height_m(points)) <= parameters.plane_tolerance_m]
    if len(inliers) < parameters.smallest_table:
        return None
    return _fit_plane(inliers)


def _plane_through(
    a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]
) -> Plane | None:
    normal = np.cross(b - a, c - a)
    length = float(np.linalg.norm(normal))
    if length < 1e-9:
        return None
    normal = normal / (length if normal[2] >= 0 else -length)
    return Plane(normal, float(normal @ a))


def _fit_plane(points: NDArray[np.float64]) -> Plane:
    centre = points.mean(axis=0)
    _, vectors = np.linalg.eigh((points - centre).T @ (points - centre))
    normal = vectors[:, 0] * np.sign(vectors[2, 0] or 1.0)
    return Plane(normal, float(normal @ centre))


def clusters(points_m: Points, distance_m: float) -> list[NDArray[np.int64]]:
    """Indices of the points of each cluster, joined by distances up to `distance_m`, largest
    cluster first."""
    if len(points_m) == 0:
        return []
    pairs = cKDTree(points_m).query_pairs(distance_m, output_type="ndarray")
    graph = coo_array(
        (np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(len(points_m),) * 2
    )
    _, labels = connected_components(graph, directed=False)
    order = np.argsort(labels, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(labels[order])) + 1)
    return sorted(parts, key=len, reverse=True)


def _largest_patch(points_m: Points, cell_m: float = 0.05) -> tuple[NDArray[np.int64], int]:
    """Indices of the largest connected patch of a surface, seen on a grid of `cell_m`, and how many
    of its cells have all four neighbours."""
    if len(points_m) == 0:
        return np.empty(0, dtype=np.int64), 0
    cells, inverse = np.unique(
        np.floor(points_m[:, :2] / cell_m).astype(np.int64), axis=0, return_inverse=True
    )
    patches = clusters(cells.astype(np.float32), 1.5)
    sizes = np.bincount(inverse, minlength=len(cells))
    largest = max(patches, key=lambda patch: int(sizes[patch].sum()))
    patch = cells[largest] - cells[largest].min(axis=0) + 1
    covered = np.zeros(patch.max(axis=0) + 2, dtype=bool)
    covered[patch[:, 0], patch[:, 1]] = True
    interior = binary_erosion(covered)
    return np.flatnonzero(np.isin(inverse, largest)), int(interior.sum())


def _over(surface_m: Points, points_m: Points, reach_m: float = 0.05) -> NDArray[np.bool_]:
    """Which points lie over the surface, seen from above."""
    if len(points_m) == 0:
        return np.empty(0, dtype=bool)
    centre = surface_m[:, :2].mean(axis=0)
    _, axes = np.linalg.eigh(np.cov((surface_m[:, :2] - centre).T))
    extent = np.abs((surface_m[:, :2] - centre) @ axes).max(axis=0) + reach_m
    over: NDArray[np.bool_] = (np.abs((points_m[:, :2] - centre) @ axes) <= extent).all(axis=1)
    return over


def supports(above: MapNode, below: MapNode) -> bool:
    """The relation r' (eq. 5.22): background above tables and objects, tables above the objects
    they carry."""
    if above.label == "background":
        return below.label in ("table", "object")
    if above.label != "table" or below.label != "object":
        return False
    box = above.box()
    if box is None:
        return False
    local = (below.T_map_node[:3, 3] - box.centre_m) @ box.axes
    # Two tables never carry the same object: the object's centre lies over one of them.
    across = np.argsort(box.half_extents_m)[1:]
    return bool((np.abs(local[across]) <= box.half_extents_m[across] + 0.05).all())


def associate(hierarchy: MapHierarchy, part: Segment) -> MapNode | None:
    """The node of the same label whose box meets the segment's, the nearest one of several
    (f'_A)."""
    if part.label == "background":
        return next((node for node in hierarchy.nodes() if node.label == "background"), None)
    box = OrientedBox.around(part.points_m)
    centre = part.points_m.mean(axis=0)
    meeting = []
    for node in hierarchy.nodes():
        if node.label != part.label:
            continue
        other = node.box()
        if other is not None and box.meets(other):
            meeting.append(node)
    return min(
        meeting,
        key=lambda node: float(np.linalg.norm(node.T_map_node[:3, 3] - centre)),
        default=None,
    )


def merge_parts(hierarchy: MapHierarchy) -> None:
    """Makes one node of objects that turned out to be one: the centre of one's box lies in the
    other's.

    A cup seen from above one side shows its front and, behind a gap, the inside of its back.
    """
    objects = [
        (node, box) for node in hierarchy.nodes() if node.label == "object" and (box := node.box())
    ]
    objects.sort(key=lambda part: -float(np.prod(part[1].half_extents_m)))
    for number, (node, box) in enumerate(objects):
        for other, smaller in objects[number + 1 :]:
            gone = node not in hierarchy or other not in hierarchy
            if not gone and box.contains(smaller.centre_m[None])[0]:
                hierarchy.merge(node, other)


def tabletop_hierarchy(
    resolutions_m: Mapping[str, float] = RESOLUTIONS_M, sensor_model: SensorModel | None = None
) -> MapHierarchy:
    """The hierarchy H' of section 5.3.4, empty."""
    return MapHierarchy({"supports": supports}, resolutions_m, associate, sensor_model)
