"""Ground truth: the building, its hidden blockades and the robots' bodies, moved by pymunk.

Bodies are discs; whoever drives them sets velocities, the physics moves them, keeps them out of
walls and out of one another, and counts every touch. A robot that drives well is never touched.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pymunk
from numpy.typing import NDArray

from simulator.fleet_scenario import HiddenBlockade, Point, Pose, ScenarioError, Segment
from simulator.occupancy_grid import OccupancyGrid
from simulator.segment_geometry import cross, nearest_on_segment

_ROBOT, _WALL, _BLOCKADE = 1, 2, 3
_BLOCKADE_HALF_WIDTH_M = 0.02
_SQUARE_M = 2.0
_LONGEST_STEP_M = 1.0
"""nobody moves that far in a step"""


@dataclass(slots=True)
class Contacts:
    """How often a robot came to touch something, and to cross what it must not."""

    wall: int = 0
    robot: int = 0
    blockade: int = 0
    crossings: int = 0
    """moves from one side of an uncleared blockade to the other"""


class World:
    """A pymunk space with the walls of a grid, blockades and robots."""

    def __init__(self, grid: OccupancyGrid, blockades: tuple[HiddenBlockade, ...]) -> None:
        self.grid = grid
        self.contacts = Contacts()
        self._space = pymunk.Space()
        self._space.collision_slop = 1e-4
        self._bodies: dict[str, pymunk.Body] = {}
        self._blockades: dict[str, tuple[HiddenBlockade, pymunk.Segment]] = {}
        self._near: dict[tuple[int, int, float], tuple[HiddenBlockade, ...]] = {}
        for segment in wall_segments(grid.walls(), grid.resolution_m, grid.origin_m):
            self._add_static(segment, 0.0, _WALL)
        for blockade in blockades:
            shape = self._add_static(blockade.segment_m, _BLOCKADE_HALF_WIDTH_M, _BLOCKADE)
            self._blockades[blockade.id] = (blockade, shape)
        for other, name in ((_WALL, "wall"), (_ROBOT, "robot"), (_BLOCKADE, "blockade")):
            self._space.on_collision(_ROBOT, other, begin=self._count, data=name)

    def _count(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: str) -> None:
        del arbiter, space
        setattr(self.contacts, data, getattr(self.contacts, data) + 1)

    def _add_static(self, segment: Segment, half_width_m: float, kind: int) -> pymunk.Segment:
        shape = pymunk.Segment(self._space.static_body, *segment, half_width_m)
        shape.collision_type = kind
        shape.friction = 0.0
        self._space.add(shape)
        return shape

    def place(self, robot: str, radius_m: float, pose: Pose) -> None:
        """Puts a robot's body into the building.

        Raises:
            ScenarioError: it would stand in a wall, in a blockade or in another robot.
        """
        body = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0.0, radius_m))
        body.position, body.angle = pose[:2], pose[2]
        shape = pymunk.Circle(body, radius_m)
        shape.collision_type = _ROBOT
        shape.friction = 0.0
        touched = self._space.shape_query(shape)
        column = int((pose[0] - self.grid.origin_m[0]) // self.grid.resolution_m)
        row = int((pose[1] - self.grid.origin_m[1]) // self.grid.resolution_m)
        rows, columns = self.grid.cells.shape
        inside = 0 <= row < rows and 0 <= column < columns
        if touched or not inside or bool(self.grid.walls()[row, column]):
            raise ScenarioError(
                f"robot {robot!r} cannot stand at ({pose[0]:.2f}, {pose[1]:.2f}): a wall, "
                f"a blockade or another robot is closer than its radius of {radius_m} m; "
                "move its start"
            )
        self._space.add(body, shape)
        self._bodies[robot] = body

    def remove(self, robot: str) -> None:
        """Takes a robot's body out, as it rides on another one from now on."""
        body = self._bodies.pop(robot)
        self._space.remove(body, *body.shapes)

    def drive(self, robot: str, velocity_m_s: tuple[float, float], turn_rad_s: float) -> None:
        """Sets a robot's velocity in the map frame until the next call."""
        body = self._bodies[robot]
        body.velocity = velocity_m_s
        body.angular_velocity = turn_rad_s

    def step(self, step_s: float) -> None:
        """Moves everything on; counts touches and crossings."""
        near = [
            (body, body.position, blockades)
            for body in self._bodies.values()
            if (blockades := self.blockades_near(body.position, _LONGEST_STEP_M))
        ]
        self._space.step(step_s)
        for body, before, blockades in near:
            move = (before, body.position)
            self.contacts.crossings += sum(cross(move, b.segment_m) for b in blockades)

    def pose(self, robot: str) -> Pose:
        """Where a robot truly is."""
        body = self._bodies[robot]
        x, y = body.position
        return (x, y, body.angle)

    def blockades(self) -> tuple[HiddenBlockade, ...]:
        """Those that stand."""
        return tuple(blockade for blockade, _ in self._blockades.values())

    def blockades_near(self, position_m: Point, within_m: float) -> tuple[HiddenBlockade, ...]:
        """Those that stand, without most of the ones that are further away than that.

        Nothing nearer is left out. Kept by squares of the floor, as robots ask in every step.
        """
        column, row = int(position_m[0] // _SQUARE_M), int(position_m[1] // _SQUARE_M)
        key = (column, row, within_m)
        if key not in self._near:
            centre = ((column + 0.5) * _SQUARE_M, (row + 0.5) * _SQUARE_M)
            reach_m = within_m + _SQUARE_M  # more than from the centre to a corner
            self._near[key] = tuple(
                blockade
                for blockade in self.blockades()
                if math.dist(centre, nearest_on_segment(centre, blockade.segment_m)) < reach_m
            )
        return self._near[key]

    def clear(self, blockade: str) -> None:
        """Removes a blockade; nothing happens if it is gone already."""
        if blockade in self._blockades:
            _, shape = self._blockades.pop(blockade)
            self._space.remove(shape)
            self._near = {}


def wall_segments(
    walls: NDArray[np.bool_], resolution_m: float, origin_m: tuple[float, float]
) -> list[Segment]:
    """The outline of the walls towards free space, straight runs merged into one segment each."""
    free = np.pad(~walls, 1)
    horizontal = free[1:, 1:-1] != free[:-1, 1:-1]
    vertical = free[1:-1, 1:] != free[1:-1, :-1]
    x0, y0 = origin_m
    segments: list[Segment] = []
    for row, start, end in _runs(horizontal):
        y = y0 + row * resolution_m
        segments.append(((x0 + start * resolution_m, y), (x0 + end * resolution_m, y)))
    for column, start, end in _runs(vertical.T):
        x = x0 + column * resolution_m
        segments.append(((x, y0 + start * resolution_m), (x, y0 + end * resolution_m)))
    return segments


def _runs(edges: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """(line, start, end) of every run of True along the second axis."""
    padded = np.pad(edges, ((0, 0), (1, 1))).astype(np.int8)
    change = np.diff(padded, axis=1)
    lines, starts = np.nonzero(change == 1)
    _, ends = np.nonzero(change == -1)
    return list(zip(lines.tolist(), starts.tolist(), ends.tolist(), strict=True))
