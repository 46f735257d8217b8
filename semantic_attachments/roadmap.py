"""A lazy probabilistic roadmap of one robot model on one map, with blockades that open and close.

Vertices are random poses and the places asked for; edges are steering motions to the k nearest
vertices. An edge is checked against the map only when it lies on a shortest path, and against a
blockade only where that is closed, so the roadmap outlives blockades. Pieces of a found path that
steer directly become edges, which shortens it. What the roadmap does not connect is tried with
poses along the grid path of a disc inside the outline, then by RRT-Connect; both become part of it.

Sources: Bohlin and Kavraki, "Path planning using lazy PRM", ICRA 2000; Karaman and Frazzoli,
"Sampling-based algorithms for optimal motion planning", IJRR 30(7), 2011 (number of neighbours,
PRM*); Kuffner and LaValle, "RRT-Connect", ICRA 2000 (OMPL's implementation).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from math import atan2, ceil, e, hypot, inf, log, pi

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import Traversability
from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.outline import Outline, inner_radius_m
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.rrt_connect import connect
from semantic_attachments.steering import Pose, steering
from semantic_attachments.world import Blockade


@dataclass(frozen=True, slots=True)
class MotionParameters:
    """How motions are sought."""

    seed: int = 0
    """Seed of all random numbers."""
    spacing_m: float = 1.5
    """Mean distance of random poses on free ground [m]."""
    most_samples: int = 2000
    """Limit of their number."""
    headings: int = 8
    """Headings tried at each place."""
    most_neighbours: int = 12
    """Limit of the number of neighbours of a vertex."""
    budget_s: float = 0.5
    """Time RRT-Connect has for a pair of places that the roadmap does not connect [s]."""
    unknown_is_free: bool = False
    """Whether robots are expected to get through unknown cells (optimistic)."""


@dataclass(frozen=True, slots=True)
class Motion:
    """The quickest motion found between two places."""

    duration_s: float
    """Infinite if there is none."""
    poses: NDArray[np.float64]
    """(n, 3) x [m], y [m], heading [rad] along it, at most half a cell apart."""


Ends = tuple[frozenset[int], frozenset[int]]
"""Vertices at which a path starts and those at which it may end touching a blockade."""

_GUIDES = 8
"""Maps of closed blockades that are kept."""

NO_MOTION = Motion(inf, np.empty((0, 3)))


class Roadmap:
    """Answers queries of one robot model on one map; not to be shared by threads."""

    def __init__(self, model: RobotModel, grid: GridMap, parameters: MotionParameters) -> None:
        self._grid = grid
        self._model = model
        self._parameters = parameters
        self._outline = Outline(model, grid, parameters.unknown_is_free)
        self._steering = steering(model, parameters.headings)
        self._step_m = grid.resolution_m / 2
        self._free_cells = np.flatnonzero(self._outline.standable)
        self._poses: list[Pose] = []
        self._from: list[int] = []
        self._to: list[int] = []
        self._duration_s: list[float] = []
        self._edge_of: dict[tuple[int, int], int] = {}
        self._checked: dict[int, bool] = {}
        self._hits: dict[tuple[int, Blockade, bool, bool], bool] = {}
        """Whether an edge touches a blockade, by edge, blockade, being first and being last."""
        self._barred: dict[Blockade, list[tuple[int, bool, bool]]] = {}
        """The edges that touch a blockade."""
        self._places: dict[PositionM, tuple[int, ...]] = {}
        self._cells: dict[Blockade, NDArray[np.uint32]] = {}
        self._asked: set[tuple[tuple[int, ...], tuple[int, ...], frozenset[Blockade]]] = set()
        """Places without path, with the blockades that were closed."""
        self._guides: dict[frozenset[Blockade], Traversability] = {}
        self._sample()

    def motions(
        self, start: PositionM, goals: Sequence[PositionM], closed: Sequence[Blockade]
    ) -> list[Motion]:
        """Quickest motions from one place to others, headings being free at both ends."""
        first = self._place(start)
        lasts = [self._place(goal) for goal in goals]
        for last in lasts:
            self._link(first, last, most=4)
        found = self._paths(first, lasts, closed)
        missing = [i for i, path in enumerate(found) if not path and first and lasts[i]]
        guided = [i for i in missing if self._follow_grid(first, lasts[i], closed)]
        if guided:
            found = self._paths(first, lasts, closed)
            missing = [i for i in guided if not found[i]]
            if any([self._ask_rrt_connect(first, lasts[i], closed) for i in missing]):  # noqa: C419
                found = self._paths(first, lasts, closed)
        return [self._motion(path) for path in found]

    def _sample(self) -> None:
        """Free poses, about one a square of the spacing, each linked to its nearest ones."""
        rng = np.random.default_rng(self._parameters.seed)
        area_m2 = float(self._outline.standable.sum()) * self._grid.resolution_m**2
        wanted = min(ceil(area_m2 / self._parameters.spacing_m**2), self._parameters.most_samples)
        for _ in range(4 * wanted):
            pose = self._random_pose(rng)
            if self._outline.is_free(*pose):
                self._poses.append(pose)
            if len(self._poses) == wanted:
                break
        self._link_nearest(range(len(self._poses)))

    def random_pose(self, rng: np.random.Generator) -> Pose:
        """A pose at which the robot can stand.

        Raises:
            ValueError: if ten thousand trials find none.
        """
        for _ in range(10_000):
            pose = self._random_pose(rng)
            if self._outline.is_free(*pose):
                return pose
        raise ValueError(f"robot type {self._model.type} does not fit on the map")

    def _random_pose(self, rng: np.random.Generator) -> Pose:
        cell = int(self._free_cells[rng.integers(self._free_cells.size)])
        centre_m = self._grid.centres_m([cell])[0]
        x, y = centre_m + rng.uniform(-0.5, 0.5, 2) * self._grid.resolution_m
        heading = 0.0 if self._steering.headings == 1 else rng.uniform(-pi, pi)
        return float(x), float(y), float(heading)

    def _link_nearest(self, vertices: Sequence[int]) -> None:
        count = len(self._poses)
        if count < 2:
            return
        dimensions = 2 if self._steering.headings == 1 else 3
        wanted = min(
            ceil(e * (1 + 1 / dimensions) * log(count)), self._parameters.most_neighbours, count - 1
        )
        # The nearest by driving are among a few times as many nearest on the map.
        candidates = min(wanted * (1 if dimensions == 2 else 3) + 1, count)
        positions_m = np.array(self._poses)[:, :2]
        from scipy.spatial import KDTree  # imported late: it takes longer than a first plan

        _, near = KDTree(positions_m).query(positions_m[list(vertices)], k=candidates)
        for vertex, others in zip(vertices, np.atleast_2d(near).tolist(), strict=True):
            for outward in (True,) if self._steering.symmetric else (True, False):
                ways = [(vertex, o) if outward else (o, vertex) for o in others if o != vertex]
                timed = sorted((self._steered_s(*way), way) for way in ways)
                for duration_s, way in timed[:wanted]:
                    self._add_edge(way, duration_s)

    def _steered_s(self, start: int, goal: int) -> float:
        return self._steering.duration_s(self._poses[start], self._poses[goal])

    def _add_edge(self, edge: tuple[int, int], duration_s: float) -> None:
        start, goal = edge
        if edge in self._edge_of:
            return
        ways = ((start, goal), (goal, start)) if self._steering.symmetric else ((start, goal),)
        shares = (0.5, 0.25, 0.75)
        poses = self._steering.at(self._poses[start], self._poses[goal], shares)
        usable = self._outline.all_free(poses)
        for way in ways:
            # An edge that is known to be useless is remembered, too, lest it is tried again.
            self._edge_of[way] = len(self._from)
            self._from.append(way[0])
            self._to.append(way[1])
            self._duration_s.append(duration_s if usable else inf)

    def _place(self, position_m: PositionM) -> tuple[int, ...]:
        """The vertices of a place: free poses at it, or else at the nearest free spot around it."""
        vertices = self._places.get(position_m)
        if vertices is not None:
            return vertices
        count = self._steering.headings
        # OMPL's headings are within [-pi, pi).
        headings = [0.0] if count == 1 else [2 * pi * k / count - pi for k in range(count)]
        resolution_m = self._grid.resolution_m
        reach = ceil(1.5 * self._outline.outer_radius_m / resolution_m) + 3
        offsets = sorted(
            ((hypot(i, j), i, j) for i, j in product(range(-reach, reach + 1), repeat=2)),
        )
        poses: list[Pose] = []
        for away, i, j in offsets:
            x, y = position_m[0] + i * resolution_m, position_m[1] + j * resolution_m
            if away <= reach and self._beside(position_m, (x, y)):
                poses = [(x, y, h) for h in headings if self._outline.is_free(x, y, h)]
                if poses:
                    break
        vertices = tuple(range(len(self._poses), len(self._poses) + len(poses)))
        self._poses.extend(poses)
        self._link_nearest(vertices)
        self._link(vertices, vertices, most=len(vertices) ** 2)
        self._places[position_m] = vertices
        return vertices

    def _beside(self, place: PositionM, spot: PositionM) -> bool:
        """Whether no wall is between a place and a spot near it."""
        between = np.linspace(
            place, spot, ceil(hypot(*np.subtract(place, spot)) / self._step_m) + 2
        )
        cells = [self._grid.cell_at((x, y)) for x, y in between[1:].tolist()]
        return all(cell is not None and self._outline.standable.flat[cell] for cell in cells)

    def _link(self, firsts: Sequence[int], lasts: Sequence[int], most: int) -> None:
        ways = [(a, b) for a, b in product(firsts, lasts) if a != b]
        for duration_s, way in sorted((self._steered_s(*way), way) for way in ways)[:most]:
            self._add_edge(way, duration_s)

    def _paths(
        self, first: Sequence[int], lasts: Sequence[Sequence[int]], closed: Sequence[Blockade]
    ) -> list[list[int]]:
        """The quickest path to each goal; a goal that touches a closed blockade is sought alone.

        The robot may touch the blockade while it arrives there, but not on its way elsewhere.
        """
        alone = [
            any(
                self._hits_blockade(np.array([self._poses[vertex]]), blockade)
                for vertex in last
                for blockade in closed
            )
            for last in lasts
        ]
        others = iter(
            self._search(
                first, [last for last, one in zip(lasts, alone, strict=True) if not one], closed
            )
        )
        return [
            self._search(first, [last], closed, arriving=last)[0] if one else next(others)
            for last, one in zip(lasts, alone, strict=True)
        ]

    def _search(
        self,
        first: Sequence[int],
        lasts: Sequence[Sequence[int]],
        closed: Sequence[Blockade],
        arriving: Sequence[int] = (),
    ) -> list[list[int]]:
        """Vertices of the quickest path to each goal; edges on them are checked and shortcuts
        added."""
        if not first or not lasts:
            return [[] for _ in lasts]
        ends = (frozenset(first), frozenset(arriving))
        while True:
            edges = len(self._from)
            weights = self._weights(closed, ends)
            count = len(self._poses)
            # Imported late: it takes longer than a first plan.
            from scipy.sparse import csr_array
            from scipy.sparse.csgraph import dijkstra

            graph = csr_array((weights, (self._from, self._to)), shape=(count, count))
            times_s, before, _ = dijkstra(
                graph, indices=list(first), return_predecessors=True, min_only=True
            )
            paths = []
            sound = True
            for last in lasts:
                best = min(last, key=lambda vertex: times_s[vertex], default=None)
                path = [] if best is None or times_s[best] == inf else _walk(before, best)
                for way in pairwise(path):
                    sound &= self._is_sound(way, closed, ends)
                self._add_shortcuts(path, times_s)
                paths.append(path)
            if sound and len(self._from) == edges:
                return paths

    def _weights(self, closed: Sequence[Blockade], ends: Ends) -> NDArray[np.float64]:
        weights = np.array(self._duration_s)
        for edge, *parting in (barred for b in closed for barred in self._barred.get(b, ())):
            if parting == [self._from[edge] in ends[0], self._to[edge] in ends[1]]:
                weights[edge] = inf
        # Sparse graphs take zeros for missing edges; two headings of a place may be no time apart.
        return np.asarray(np.maximum(weights, 1e-12))

    def _is_sound(self, way: tuple[int, int], closed: Sequence[Blockade], ends: Ends) -> bool:
        """Checks an edge as far as that was not done before."""
        start, goal = way
        edge = self._edge_of[way]
        poses: NDArray[np.float64] | None = None
        if edge not in self._checked:
            poses = self._steering.poses(self._poses[start], self._poses[goal], self._step_m)
            self._checked[edge] = self._outline.all_free(poses)
            if not self._checked[edge]:
                self._duration_s[edge] = inf
            if self._steering.symmetric:
                back = self._edge_of[goal, start]
                self._checked[back] = self._checked[edge]
                self._duration_s[back] = self._duration_s[edge]
        sound = self._checked[edge]
        for blockade in closed:
            key = (edge, blockade, start in ends[0], goal in ends[1])
            if key not in self._hits:
                if poses is None:
                    poses = self._steering.poses(
                        self._poses[start], self._poses[goal], self._step_m
                    )
                parting = _without_parting(poses, blockade, leaves=key[2], arrives=key[3])
                self._hits[key] = self._hits_blockade(parting, blockade)
                if self._hits[key]:
                    self._barred.setdefault(blockade, []).append((edge, *key[2:]))
            sound &= not self._hits[key]
        return sound

    def _hits_blockade(self, poses: NDArray[np.float64], blockade: Blockade) -> bool:
        reach_m = self._outline.outer_radius_m + blockade.thickness_m + 2 * self._grid.resolution_m
        ends = np.array(blockade.segment_m)
        low, high = ends.min(axis=0) - reach_m, ends.max(axis=0) + reach_m
        near = poses[np.all((poses[:, :2] >= low) & (poses[:, :2] <= high), axis=1)]
        return bool(len(near)) and self._outline.hits(near, self._blockade_cells(blockade))

    def _add_shortcuts(self, path: Sequence[int], times_s: NDArray[np.float64]) -> None:
        corners = (
            path if len(path) <= 12 else [path[round(i * (len(path) - 1) / 11)] for i in range(12)]
        )
        for i, start in enumerate(corners):
            for goal in corners[i + 2 :]:
                if (start, goal) not in self._edge_of:
                    duration_s = self._steered_s(start, goal)
                    if duration_s < times_s[goal] - times_s[start] - 1e-6:
                        self._add_edge((start, goal), duration_s)

    def _ask_rrt_connect(
        self, first: tuple[int, ...], last: tuple[int, ...], closed: Sequence[Blockade]
    ) -> bool:
        """Whether RRT-Connect found a motion."""

        def is_free(x: float, y: float, heading: float) -> bool:
            if not self._outline.is_free(x, y, heading):
                return False
            pose = np.array([[x, y, heading]])
            return not any(self._hits_blockade(pose, blockade) for blockade in closed)

        poses = connect(
            self._model,
            self._grid,
            [self._poses[vertex] for vertex in first],
            [self._poses[vertex] for vertex in last],
            is_free=is_free,
            budget_s=self._parameters.budget_s,
        )
        if len(poses) < 2:
            return False
        vertices = []
        for pose in poses:
            known = [v for v in (*first, *last) if np.allclose(self._poses[v], pose)]
            vertices.append(known[0] if known else len(self._poses))
            if not known:
                self._poses.append(pose)
        for a, b in pairwise(vertices):
            self._add_edge((a, b), self._steered_s(a, b))
        return True

    def _follow_grid(
        self, first: tuple[int, ...], last: tuple[int, ...], closed: Sequence[Blockade]
    ) -> bool:
        """Adds poses along the grid path of the disc inside the outline; whether that is worth it.

        It is not if that disc does not get through, since then the outline does not, or if it was
        done before for the same question. Random poses seldom stand in doors, those added do.
        """
        question = (first, last, frozenset(closed))
        if question in self._asked:
            return False
        self._asked.add(question)
        cells = [self._grid.cell_at(self._poses[vertex][:2]) for vertex in (first[0], last[0])]
        map_ = self._guide(closed)
        limit = 3 + 2 * self._outline.outer_radius_m / self._grid.resolution_m
        ends = [map_.nearest(cell, [], limit) for cell in cells if cell is not None]
        if len(ends) < 2 or ends[0] is None or ends[1] is None:
            return len(ends) == 2
        way_m = self._grid.centres_m(map_.field(ends[0][0]).path_to(ends[1][0]))
        stride = max(round(self._outline.outer_radius_m / self._grid.resolution_m), 1)
        added = len(self._poses)
        for index in range(0, len(way_m), stride):
            ahead_m = way_m[min(index + stride, len(way_m) - 1)]
            behind_m = way_m[max(index - stride, 0)]
            heading = atan2(*(ahead_m - behind_m)[::-1]) if self._steering.headings > 1 else 0.0
            x, y = way_m[index].tolist()
            headings = [heading] if self._steering.headings == 1 else [heading, heading + pi]
            poses = [(x, y, (h + pi) % (2 * pi) - pi) for h in headings]
            self._poses.extend(pose for pose in poses if self._outline.is_free(*pose))
        self._link_nearest(range(added, len(self._poses)))
        return len(way_m) > 0

    def _guide(self, closed: Sequence[Blockade]) -> Traversability:
        """The map for the disc inside the outline, slower near walls: its paths keep off them."""
        key = frozenset(closed)
        if key not in self._guides:
            if len(self._guides) >= _GUIDES:
                self._guides.clear()
            # A disc smaller by what cells may hide passes wherever the inner disc does.
            inner_cells = inner_radius_m(self._model) / self._grid.resolution_m - 1.5
            outer_cells = self._outline.outer_radius_m / self._grid.resolution_m + 1
            gap = np.minimum(self._outline.clearance_cells, 2 * outer_cells)
            self._guides[key] = Traversability(
                self._outline.solid,
                ~self._outline.standable & ~self._outline.solid,
                max(inner_cells, 0.0),
                (1 + 4 * np.clip(1 - gap / (2 * outer_cells), 0, 1)).astype(np.float32),
                [self._blockade_cells(blockade) for blockade in closed],
            )
        return self._guides[key]

    def _blockade_cells(self, blockade: Blockade) -> NDArray[np.uint32]:
        if blockade not in self._cells:
            self._cells[blockade] = blockade.cells(self._grid)
        return self._cells[blockade]

    def _motion(self, path: Sequence[int]) -> Motion:
        if not path:
            return NO_MOTION
        pieces = [
            self._steering.poses(self._poses[a], self._poses[b], self._step_m)
            for a, b in pairwise(path)
        ]
        duration_s = sum(self._duration_s[self._edge_of[way]] for way in pairwise(path))
        poses = np.vstack(pieces) if pieces else np.array([self._poses[path[0]]])
        return Motion(round(duration_s, 9), poses)


def _walk(before: NDArray[np.int32], goal: int) -> list[int]:
    path = [goal]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return path[::-1]


def _without_parting(
    poses: NDArray[np.float64], blockade: Blockade, *, leaves: bool, arrives: bool
) -> NDArray[np.float64]:
    """The poses without those at a place while the robot only gets away from the blockade.

    A robot that was stopped by a blockade stands against it, and may leave.
    """
    start, end = np.array(blockade.segment_m)
    along = end - start
    share = np.clip((poses[:, :2] - start) @ along / max(float(along @ along), 1e-12), 0, 1)
    away_m = np.linalg.norm(poses[:, :2] - (start + share[:, None] * along), axis=1)
    parting, nearing = np.diff(away_m) > 0, np.diff(away_m) < 0
    first = int(np.argmin(np.append(parting, False))) if leaves else 0
    last = int(np.argmin(np.append(nearing[::-1], False))) if arrives else 0
    return poses[first + 1 if first else 0 : len(poses) - (last + 1 if last else 0)]
