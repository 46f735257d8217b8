"""Exploration by robots that follow their paths exactly: no bodies, no drives, no noise.

For experiments that compare coordination strategies over hundreds of runs. Scans come from the
same native ray caster and go into the same occupancy map as the fleet simulation's; whoever decides
where to go sees that map alone. Robots do not stand in one another's way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulator._core import Floor
from simulator.fleet_scenario import Point, Pose
from simulator.mapping.occupancy import JointOccupancyMap
from simulator.occupancy_grid import OccupancyGrid
from simulator.sensors import Scan


@dataclass(frozen=True, slots=True)
class KinematicParameters:
    """Drive and senses of the robots; all are alike."""

    speed_m_s: float = 0.5
    sensor_range_m: float = 5.0
    beams: int = 180
    """over the full circle"""
    field_of_view_rad: float = 2.0 * math.pi
    """the beams outside of it, which is centred ahead, are not made while driving"""
    measuring_s: float = 0.0
    """how long a robot stands at a target to look all around"""
    communication_range_m: float | None = None
    """robots hear one another, and relay, up to here; None for everywhere"""
    step_s: float = 1.0
    """between two scans of a robot"""
    news_interval_s: float = 2.0
    """how soon after a decision the next one may follow because a target has lost its purpose"""
    time_limit_s: float = 20_000.0


@dataclass(frozen=True, slots=True)
class Errand:
    """Where a robot is sent."""

    path_m: NDArray[np.float64]
    """(n, 2) way points in the map frame, the robot's position first"""
    purpose: NDArray[np.int64]
    """(n,) unknown cells it goes to see, `row * columns + column`; done when all are known"""


@dataclass(frozen=True, slots=True)
class TeamView:
    """What robots that hear one another know together."""

    time_s: float
    grid: OccupancyGrid
    positions_m: Mapping[str, Point]
    """of those that can be sent somewhere; others stand and measure"""
    members: frozenset[str]
    """all robots that know this map"""


class Decide(Protocol):
    """Whoever coordinates a team, or a part of it that is out of touch with the rest."""

    def __call__(self, view: TeamView) -> Mapping[str, Errand]:
        """The errands of the robots; one without stays where it is."""
        ...


@dataclass(slots=True)
class _Explorer:
    id: str
    x: float
    y: float
    heading_rad: float
    map: JointOccupancyMap
    errand: Errand | None = None
    leg: int = 0
    driven_m: float = 0.0
    measures_until_s: float = -math.inf
    decided_s: float = -math.inf
    refused: bool = False
    """it was given nothing to do since it last heard anything new"""
    track: list[tuple[float, float, float]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class ExplorationResult:
    """How an exploration went."""

    duration_s: float
    completed: bool
    """nothing reachable was left to explore before the time limit"""
    driven_m: dict[str, float]
    tracks: dict[str, NDArray[np.float64]]
    """robot -> (samples, 3): time [s], x [m], y [m]"""
    known_share: float
    """share of the building's free cells that somebody has seen"""
    known_share_over_time: NDArray[np.float64]
    """(samples, 2): time [s], share, every ten seconds"""
    decisions: int
    clusters: int
    """the most groups of robots out of touch with one another at any time"""
    grid: OccupancyGrid
    """what the team knows in the end, all maps together"""


class KinematicExploration:
    """One team in one building of which it knows nothing."""

    def __init__(
        self,
        truth: OccupancyGrid,
        starts: Mapping[str, Pose],
        parameters: KinematicParameters | None = None,
    ) -> None:
        self.parameters = parameters or KinematicParameters()
        self._truth = truth
        self._floor = Floor(truth.walls(), truth.resolution_m, truth.origin_m)
        shared = JointOccupancyMap(truth.cells.shape, truth.resolution_m, truth.origin_m)
        self._robots = [_Explorer(name, *pose, shared) for name, pose in starts.items()]
        self._time_s = 0.0
        self._decisions = 0
        self._members: set[frozenset[str]] = set()
        self._most_clusters = 1

    def run(self, decide: Decide) -> ExplorationResult:
        """Explores until nobody is given an errand any more, or the time is over."""
        parameters = self.parameters
        progress: list[tuple[float, float]] = []
        self._share_maps()
        for robot in self._robots:
            self._scan(robot, all_around=True)
        completed = False
        while not completed and self._time_s < parameters.time_limit_s:
            clusters = self._share_maps()
            for cluster in clusters:
                if self._needs_decision(cluster):
                    self._decide(cluster, decide)
            completed = all(
                robot.errand is None and self._time_s >= robot.measures_until_s
                for robot in self._robots
            )
            if len(progress) <= self._time_s / 10.0:
                progress.append((self._time_s, self._known_share()))
            if not completed:
                self._time_s += parameters.step_s
                for robot in self._robots:
                    self._move(robot)
        progress.append((self._time_s, self._known_share()))
        return ExplorationResult(
            duration_s=self._time_s,
            completed=completed,
            driven_m={robot.id: robot.driven_m for robot in self._robots},
            tracks={robot.id: np.array(robot.track) for robot in self._robots},
            known_share=progress[-1][1],
            known_share_over_time=np.array(progress),
            decisions=self._decisions,
            clusters=self._most_clusters,
            grid=self._everything().grid(),
        )

    # --- deciding ---

    def _needs_decision(self, cluster: Sequence[_Explorer]) -> bool:
        """Somebody has arrived, or wants another target because its own is explored by now."""
        asking = any(
            robot.errand is None and not robot.refused and self._time_s >= robot.measures_until_s
            for robot in cluster
        )
        decided_s = max(robot.decided_s for robot in cluster)
        if asking or self._time_s - decided_s < self.parameters.news_interval_s:
            return asking
        cells = cluster[0].map.cells().ravel()
        return any(
            robot.errand is not None and bool((cells[robot.errand.purpose] >= 0).all())
            for robot in cluster
        )

    def _decide(self, cluster: Sequence[_Explorer], decide: Decide) -> None:
        ready = [robot for robot in cluster if self._time_s >= robot.measures_until_s]
        view = TeamView(
            self._time_s,
            cluster[0].map.grid(),
            {robot.id: (robot.x, robot.y) for robot in ready},
            frozenset(robot.id for robot in cluster),
        )
        errands = decide(view)
        self._decisions += 1
        for robot in cluster:
            robot.decided_s = self._time_s
        for robot in ready:
            robot.errand, robot.leg = errands.get(robot.id), 0
            robot.refused = robot.errand is None

    # --- driving and measuring ---

    def _move(self, robot: _Explorer) -> None:
        if self._time_s < robot.measures_until_s or robot.errand is None:
            return
        left_m = self.parameters.speed_m_s * self.parameters.step_s
        path = robot.errand.path_m
        while left_m > 1e-9 and robot.leg + 1 < len(path):
            x, y = (float(value) for value in path[robot.leg + 1])
            apart_m = math.hypot(x - robot.x, y - robot.y)
            if apart_m > 1e-9:
                robot.heading_rad = math.atan2(y - robot.y, x - robot.x)
            share = 1.0 if apart_m <= left_m else left_m / apart_m
            robot.x += share * (x - robot.x)
            robot.y += share * (y - robot.y)
            robot.driven_m += share * apart_m
            left_m -= share * apart_m
            robot.leg += share == 1.0
        robot.track.append((self._time_s, robot.x, robot.y))
        arrived = robot.leg + 1 >= len(path)
        self._scan(robot, all_around=arrived)
        if arrived:
            robot.errand = None
            robot.measures_until_s = self._time_s + self.parameters.measuring_s

    def _scan(self, robot: _Explorer, *, all_around: bool) -> None:
        parameters = self.parameters
        ranges_m, _ = self._floor.scan(
            robot.x,
            robot.y,
            robot.heading_rad,
            parameters.sensor_range_m,
            parameters.beams,
            [],
            [],
        )
        if not all_around and parameters.field_of_view_rad < 2.0 * math.pi:
            beam = np.arange(parameters.beams) * (2.0 * math.pi / parameters.beams)
            aside = np.minimum(beam, 2.0 * math.pi - beam)
            ranges_m[aside > parameters.field_of_view_rad / 2.0] = np.nan
        pose = (robot.x, robot.y, robot.heading_rad)
        robot.map.insert(
            Scan(robot.id, self._time_s, pose, parameters.sensor_range_m, ranges_m, ())
        )

    # --- knowing together ---

    def _share_maps(self) -> list[list[_Explorer]]:
        """Robots that hear one another; they merge what they know, others part company."""
        range_m = self.parameters.communication_range_m
        if range_m is None:
            return [self._robots]
        clusters: list[list[_Explorer]] = []
        for robot in self._robots:
            near = [c for c in clusters if any(_apart_m(robot, other) <= range_m for other in c)]
            joined = [other for cluster in near for other in cluster] + [robot]
            clusters = [c for c in clusters if c not in near] + [joined]
        self._most_clusters = max(self._most_clusters, len(clusters))
        members = {frozenset(robot.id for robot in cluster) for cluster in clusters}
        if members != self._members:
            self._members = members
            for cluster, joint in [(cluster, _merged(cluster)) for cluster in clusters]:
                for robot in cluster:
                    robot.map, robot.refused = joint, False
        return clusters

    def _everything(self) -> JointOccupancyMap:
        return _merged(self._robots)

    def _known_share(self) -> float:
        free = self._truth.cells == 0
        return float((self._everything().cells()[free] >= 0).mean())


def _merged(robots: Sequence[_Explorer]) -> JointOccupancyMap:
    """A new map of all that these robots know."""
    maps = {id(robot.map): robot.map for robot in robots}
    first, *others = maps.values()
    joint = first.copy()
    for other in others:
        joint.merge(other)
    return joint


def _apart_m(one: _Explorer, other: _Explorer) -> float:
    return math.hypot(one.x - other.x, one.y - other.y)
