"""A lazy probabilistic roadmap of one robot model on one map, with blockades that open and close.

Vertices are random poses and the places asked for; edges are steering motions to the k nearest
vertices. An edge is checked against the map only when the search for shortest paths is about to
take it, and against a blockade only where that is closed, so the roadmap outlives blockades. Pieces
of a found path that steer directly become edges, which shortens it. What the roadmap does not
connect is tried with poses along the grid path of a disc inside the outline, then by RRT-Connect,
whose motions BIT* shortens; all become part of it.

Sources: Bohlin and Kavraki, "Path planning using lazy PRM", ICRA 2000; Karaman and Frazzoli,
"Sampling-based algorithms for optimal motion planning", IJRR 30(7), 2011 (number of neighbours,
PRM*).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise, product
from math import ceil, e, inf, isfinite, log

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import LazyGraph
from semantic_attachments.bit_star import shortened
from semantic_attachments.edge_check import EdgeCheck
from semantic_attachments.grid_guide import GridGuide
from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.motion_parameters import MotionParameters
from semantic_attachments.motion_space import MotionSpace
from semantic_attachments.outline import Outline
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.rrt_connect import connect
from semantic_attachments.standing import Standing
from semantic_attachments.steering import Pose, steering
from semantic_attachments.world import Blockade


@dataclass(frozen=True, slots=True)
class Motion:
    """The quickest motion found between two places."""

    duration_s: float
    """Infinite if there is none."""
    poses: NDArray[np.float64]
    """(n, 3) x [m], y [m], heading [rad] along it, at most half a cell apart."""


NO_MOTION = Motion(inf, np.empty((0, 3)))

Way = tuple[float, list[int]]
"""Duration [s], infinite if there is none, and vertices of a way."""


class Roadmap:
    """Answers queries of one robot model on one map; not to be shared by threads."""

    def __init__(self, model: RobotModel, grid: GridMap, parameters: MotionParameters) -> None:
        self._grid = grid
        self._model = model
        self._parameters = parameters
        self._outline = Outline(model, grid, parameters.unknown_is_free)
        self._steering = steering(model, parameters.headings)
        self._check = EdgeCheck(self._outline, self._steering, grid)
        headings = self._steering.headings
        self._standing = Standing(self._outline, grid, headings)
        self._guide = GridGuide(model, self._outline, grid, headings, self._check.cells)
        self._graph = LazyGraph()
        self._poses: list[Pose] = []
        self._edges: list[tuple[int, int]] = []
        """Start and goal of each edge, as numbered by the graph."""
        self._duration_s: dict[tuple[int, int], float] = {}
        self._places: dict[PositionM, tuple[int, ...]] = {}
        self._asked: set[tuple[tuple[int, ...], tuple[int, ...], frozenset[Blockade]]] = set()
        """Places without path, with the blockades that were closed."""
        wanted = ceil(self._standing.area_m2() / parameters.spacing_m**2)
        rng = np.random.default_rng(parameters.seed)
        poses = self._standing.draw_many(rng, min(wanted, parameters.most_samples))
        self._link_nearest(self._add(poses))

    def motions(
        self, start: PositionM, goals: Sequence[PositionM], closed: Sequence[Blockade]
    ) -> list[Motion]:
        """Quickest motions from one place to others, headings being free at both ends."""
        first = self._place(start)
        return [self._motion(first, way) for way in self._seek(first, goals, closed)]

    def durations_s(
        self, start: PositionM, goals: Sequence[PositionM], closed: Sequence[Blockade]
    ) -> list[float]:
        """Durations of these motions [s]; infinite if there is none."""
        return [round(way[0], 9) for way in self._seek(self._place(start), goals, closed)]

    def _seek(
        self, first: tuple[int, ...], goals: Sequence[PositionM], closed: Sequence[Blockade]
    ) -> list[Way]:
        lasts = [self._place(goal) for goal in goals]
        for last in lasts:
            self._link(first, last, most=4)
        found = self._ways(first, lasts, closed)
        missing = [i for i, way in enumerate(found) if way[0] == inf and first and lasts[i]]
        guided = [i for i in missing if self._follow_grid(first, lasts[i], closed)]
        if guided:
            found = self._ways(first, lasts, closed)
            missing = [i for i in guided if found[i][0] == inf]
            if any([self._ask_rrt_connect(first, lasts[i], closed) for i in missing]):  # noqa: C419
                found = self._ways(first, lasts, closed)
        return found

    def random_pose(self, rng: np.random.Generator) -> Pose:
        """A pose at which the robot can stand.

        Raises:
            ValueError: if ten thousand trials find none.
        """
        for _ in range(10_000):
            pose = self._standing.draw(rng)
            if pose is not None:
                return pose
        raise ValueError(f"robot type {self._model.type} does not fit on the map")

    def _add(self, poses: Sequence[Pose]) -> tuple[int, ...]:
        """New vertices."""
        self._poses.extend(poses)
        return tuple(self._graph.add_vertex(x, y) for x, y, _ in poses)

    def _add_edge(self, start: int, goal: int, duration_s: float) -> bool:
        """Whether the edge is new."""
        if (start, goal) in self._duration_s:
            return False
        # The robot's position moves at most as far as it drives meanwhile.
        length_m = duration_s * self._model.speed_m_s
        ways = [(start, goal), (goal, start)] if self._steering.symmetric else [(start, goal)]
        for a, b in ways:
            self._graph.add_edge(a, b, duration_s, length_m)
            self._edges.append((a, b))
            self._duration_s[a, b] = duration_s
        return True

    def _link_nearest(self, vertices: Sequence[int]) -> None:
        count = len(self._poses)
        if count < 2 or not vertices:
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
                timed = sorted((self._steered_s(a, b), a, b) for a, b in ways)
                for duration_s, a, b in timed[:wanted]:
                    self._add_edge(a, b, duration_s)

    def _steered_s(self, start: int, goal: int) -> float:
        return self._steering.duration_s(self._poses[start], self._poses[goal])

    def _place(self, position_m: PositionM) -> tuple[int, ...]:
        """The vertices of a place."""
        vertices = self._places.get(position_m)
        if vertices is None:
            vertices = self._places[position_m] = self._add(self._standing.at(position_m))
            self._link_nearest(vertices)
            self._link(vertices, vertices, most=len(vertices) ** 2)
        return vertices

    def _link(self, firsts: Sequence[int], lasts: Sequence[int], most: int) -> None:
        timed = [(self._steered_s(a, b), a, b) for a, b in product(firsts, lasts) if a != b]
        for duration_s, a, b in sorted(timed)[:most]:
            self._add_edge(a, b, duration_s)

    def _ways(
        self, first: Sequence[int], lasts: Sequence[Sequence[int]], closed: Sequence[Blockade]
    ) -> list[Way]:
        """The quickest way to each goal; a goal that touches a closed blockade is sought alone.

        The robot may touch the blockade while it arrives there, but not on its way elsewhere.
        """
        alone = [
            any(
                self._check.poses_touch(np.array([self._poses[vertex]]), blockade)
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
    ) -> list[Way]:
        """The quickest way to each goal, after shortcuts."""
        if not first or not lasts:
            return [(inf, []) for _ in lasts]
        leaving, arrival = frozenset(first), frozenset(arriving)
        walls = self._check.walls(closed)

        def look(edge: int) -> tuple[bool, bool]:
            """Whether an edge can be driven, and whether it could without blockades."""
            way = start, goal = self._edges[edge]
            ends = self._poses[start], self._poses[goal]
            if not self._check.is_free(way, ends):
                return False, False
            parts = {"leaves": start in leaving, "arrives": goal in arrival}
            return not any(self._check.touches(way, ends, b, **parts) for b in closed), True

        while True:
            found = self._graph.search(list(first), [list(last) for last in lasts], walls, look)
            ways = [(duration_s, self._vertices(edges)) for duration_s, edges in found]
            if not any([self._add_shortcuts(vertices) for _, vertices in ways]):  # noqa: C419
                return ways

    def _vertices(self, edges: Sequence[int]) -> list[int]:
        ways = [self._edges[edge] for edge in edges]
        return [ways[0][0], *(goal for _, goal in ways)] if ways else []

    def _add_shortcuts(self, vertices: Sequence[int]) -> bool:
        """Whether there are new edges between vertices of a way that would make it quicker."""
        count = len(vertices)
        durations_s = [self._duration_s[way] for way in pairwise(vertices)]
        times_s = dict(zip(vertices, accumulate(durations_s, initial=0.0), strict=False))
        corners = (
            vertices if count <= 12 else [vertices[round(i * (count - 1) / 11)] for i in range(12)]
        )
        added = False
        for i, start in enumerate(corners):
            for goal in corners[i + 2 :]:
                if (start, goal) not in self._duration_s:
                    duration_s = self._steered_s(start, goal)
                    if duration_s < times_s[goal] - times_s[start] - 1e-6:
                        added |= self._add_edge(start, goal, duration_s)
        return added

    def _follow_grid(
        self, first: tuple[int, ...], last: tuple[int, ...], closed: Sequence[Blockade]
    ) -> bool:
        """Adds poses along the grid path; whether there is one, and this was not tried before."""
        question = (first, last, frozenset(closed))
        if question in self._asked:
            return False
        self._asked.add(question)
        poses = self._guide.poses(self._poses[first[0]][:2], self._poses[last[0]][:2], closed)
        if poses is None:
            return False
        self._link_nearest(self._add(poses))
        return True

    def _ask_rrt_connect(
        self, first: tuple[int, ...], last: tuple[int, ...], closed: Sequence[Blockade]
    ) -> bool:
        """Adds the motion that RRT-Connect finds, and a shorter one; whether it found one."""

        def is_free(x: float, y: float, heading: float) -> bool:
            if not self._outline.is_free(x, y, heading):
                return False
            pose = np.array([[x, y, heading]])
            return not any(self._check.poses_touch(pose, blockade) for blockade in closed)

        space = MotionSpace(self._model, self._grid, is_free)
        starts, goals = ([self._poses[vertex] for vertex in ends] for ends in (first, last))
        poses = connect(space, starts, goals, self._parameters.budget_s)
        if len(poses) < 2:
            return False
        self._add_way(poses, (*first, *last))
        if self._parameters.improvement_s > 0:
            self._add_way(shortened(space, poses, self._parameters.improvement_s), (*first, *last))
        return True

    def _add_way(self, poses: Sequence[Pose], ends: Sequence[int]) -> None:
        """Poses that are joined by steering, between some of the vertices `ends`."""
        vertices = []
        for pose in poses:
            known = [v for v in ends if np.allclose(self._poses[v], pose)]
            vertices.append(known[0] if known else self._add([pose])[0])
        for start, goal in pairwise(vertices):
            self._add_edge(start, goal, self._steered_s(start, goal))

    def _motion(self, first: Sequence[int], way: Way) -> Motion:
        duration_s, vertices = way
        if not isfinite(duration_s):
            return NO_MOTION
        if not vertices:
            return Motion(0.0, np.array([self._poses[first[0]]]))
        pieces = [
            self._steering.poses(self._poses[a], self._poses[b], self._check.step_m)
            for a, b in pairwise(vertices)
        ]
        return Motion(round(duration_s, 9), np.vstack(pieces))
