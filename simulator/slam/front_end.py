"""SLAM front end of one robot: scans and odometry in, a pose graph with loops closed out.

Thesis 4.3.1: a node a scan, consecutive nodes connected by scan matching with its covariance, loop
closures sought among neighbouring nodes whenever a node is added. The back end runs after each.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from simulator.slam.back_end import (
    BackEndParameters,
    IncrementalBackEnd,
    optimise_with_outliers,
)
from simulator.slam.odometry import OdometryModel
from simulator.slam.pose import Poses, between, compose
from simulator.slam.pose_graph import Edge, PoseGraph
from simulator.slam.range_scan import RangeScan
from simulator.slam.robot_map import RobotMap
from simulator.slam.scan_matching import ScanMatchParameters, match, surfaces


@dataclass(frozen=True, slots=True)
class LoopParameters:
    """When a place counts as seen before."""

    youngest: int = 30
    """nodes between a place and its revisit, at least"""
    radius_m: float = 3.0
    """how near an older node has to be"""
    drift: float = 0.02
    """the radius grows by this share of the way driven since"""
    radius_limit_m: float = 6.0
    window_rad: float = 0.4
    least_score: float = 0.5
    """mean correlative value per point"""
    least_share: float = 0.7
    """share of points near one of the older place"""
    neighbours: int = 4
    """nodes before and after an older one that make up its surroundings"""
    every: int = 2
    """nodes between two attempts"""


@dataclass(frozen=True, slots=True)
class FrontEndParameters:
    """How one robot's graph is built."""

    node_distance_m: float = 0.4
    node_turn_rad: float = 0.35
    recent: int = 8
    """nodes whose scans a new one is matched to"""
    window_m: float = 0.3
    window_rad: float = 0.25
    wide_window_m: float = 1.0
    """looked through when nothing fits in the narrow window: scans and odometry out of step"""
    wide_window_rad: float = 0.7
    odometry: OdometryModel = field(default_factory=OdometryModel)
    matching: ScanMatchParameters = field(default_factory=ScanMatchParameters)
    loops: LoopParameters | None = field(default_factory=LoopParameters)
    """None closes no loops"""
    back_end: BackEndParameters = field(default_factory=lambda: BackEndParameters(kernel="huber"))


class FrontEnd:
    """Takes one scan after the other; `robot_map` is the estimate so far."""

    def __init__(self, robot: str, parameters: FrontEndParameters | None = None) -> None:
        self.robot = robot
        self.parameters = parameters or FrontEndParameters()
        self.graph = PoseGraph()
        self.scans: dict[int, RangeScan] = {}
        self._back_end = IncrementalBackEnd(self.parameters.back_end)
        self._driven_m: list[float] = []

    @property
    def robot_map(self) -> RobotMap:
        """Graph and scans so far; the graph is not copied."""
        return RobotMap(self.robot, self.graph, dict(self.scans))

    def pose(self, odometry: Poses) -> Poses:
        """(3,): where the robot is in its own frame, with a newer odometry reading."""
        if not self.scans:
            return np.zeros(3)
        last = max(self.scans)
        return compose(self.graph.poses[last], between(self.scans[last].odometry, odometry))

    def add(self, scan: RangeScan) -> bool:
        """Takes a scan in if the robot moved far enough since the last node; says whether."""
        if not self.scans:
            self._add_node(0, np.zeros(3), scan)
            self.graph.poses = self._back_end.update()
            return True
        last = max(self.scans)
        motion = between(self.scans[last].odometry, scan.odometry)
        length = float(np.hypot(motion[0], motion[1]))
        if (
            length < self.parameters.node_distance_m
            and abs(motion[2]) < self.parameters.node_turn_rad
        ):
            return False
        edge = self._consecutive(last, motion, scan)
        self._driven_m.append(length)
        self._add_node(edge.end, compose(self.graph.poses[last], edge.measurement), scan)
        self._add_edge(edge)
        self.graph.poses = self._back_end.update()
        loops = self.parameters.loops
        if loops is not None and edge.end % loops.every == 0:
            closure = self._loop_closure(edge.end, loops)
            if closure is not None:
                self._add_edge(closure)
                self.graph.poses = self._back_end.update(relinearisations=3)
        return True

    def finish(self) -> RobotMap:
        """Batch optimisation with graduated non-convexity over the loop closures."""
        if any(edge.kind == "loop" for edge in self.graph.edges):
            self.graph = optimise_with_outliers(
                self.graph, self.parameters.back_end, doubtful=("loop",)
            ).graph
        return self.robot_map

    def _add_node(self, key: int, pose: Poses, scan: RangeScan) -> None:
        self._back_end.add_pose(key, pose)
        self.graph.poses[key] = pose
        self.scans[key] = scan

    def _add_edge(self, edge: Edge) -> None:
        self._back_end.add_edge(edge)
        self.graph.edges.append(edge)

    def _consecutive(self, last: int, motion: Poses, scan: RangeScan) -> Edge:
        """The motion since the last node, from odometry and scan matching together."""
        odometry = self.parameters.odometry.information(motion)
        recent = list(range(max(0, last - self.parameters.recent + 1), last + 1))
        narrow = (self.parameters.window_m, self.parameters.window_rad)
        wide = (self.parameters.wide_window_m, self.parameters.wide_window_rad)
        for window, least in ((narrow, (0.4, 0.5)), (wide, (0.4, 0.5))):
            found = self._match_to(
                recent, last, scan, motion, window=window, prior=odometry, least=least
            )
            if found is not None:
                pose, information = found
                return Edge(last, last + 1, pose, information + odometry)
        return Edge(last, last + 1, motion, odometry)

    def _match_to(
        self,
        keys: Sequence[int],
        origin: int,
        scan: RangeScan,
        guess: Poses,
        *,
        window: tuple[float, float],
        prior: NDArray[np.float64] | None,
        least: tuple[float, float],
    ) -> tuple[Poses, NDArray[np.float64]] | None:
        """Pose of a scan in the frame of a node, matched to the scans of several nodes."""
        frame = self.graph.poses[origin]
        around = [(between(frame, self.graph.poses[key]), self.scans[key]) for key in keys]
        around = [(pose, seen) for pose, seen in around if np.any(seen.hits())]
        if not around:
            return None
        matching = replace(self.parameters.matching, least_score=least[0])
        found = match(surfaces(around), scan, guess, window, matching, prior=prior)
        if found is None or found.score < least[1]:
            return None
        return found.pose, found.information

    def _loop_closure(self, key: int, loops: LoopParameters) -> Edge | None:
        """A constraint to an older node nearby, if the scan fits to its surroundings."""
        old = key - loops.youngest
        if old < 0:
            return None
        here = self.graph.poses[key]
        older = np.array([self.graph.poses[other] for other in range(old + 1)])
        apart = np.hypot(older[:, 0] - here[0], older[:, 1] - here[1])
        candidate = int(np.argmin(apart))
        since_m = float(np.sum(self._driven_m[candidate:key]))
        radius_m = min(loops.radius_limit_m, loops.radius_m + loops.drift * since_m)
        if apart[candidate] > radius_m:
            return None
        near = range(
            max(0, candidate - loops.neighbours), min(old, candidate + loops.neighbours) + 1
        )
        guess = between(self.graph.poses[candidate], here)
        window = (min(radius_m, 0.5 + loops.drift * since_m), loops.window_rad)
        found = self._match_to(
            list(near),
            candidate,
            self.scans[key],
            guess,
            window=window,
            prior=None,
            least=(loops.least_score, loops.least_share),
        )
        if found is None or np.min(np.linalg.eigvalsh(found[1])) < 10.0:
            # A place that leaves a direction open closes no loop.
            return None
        return Edge(candidate, key, found[0], found[1], "loop")


def build_map(
    robot: str, scans: Iterable[RangeScan], parameters: FrontEndParameters | None = None
) -> RobotMap:
    """Single-robot SLAM over a whole log."""
    front_end = FrontEnd(robot, parameters)
    for scan in scans:
        front_end.add(scan)
    return front_end.finish()
