"""Learns the model of a table on its own (Wurm, section 5.4, Algorithm 5)."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator.mapping.hierarchy import MapHierarchy
from simulator.mapping.octree import OctreeMap
from simulator.mapping.oriented_box import OrientedBox
from simulator.mapping.scene import DepthSensor
from simulator.mapping.tabletop import (
    TabletopParameters,
    merge_parts,
    segment,
    tabletop_hierarchy,
)
from simulator.mapping.traversability import Passage, traversability
from simulator.mapping.viewpoints import (
    NoWayError,
    Platform,
    Viewpoint,
    Ways,
    nearest_table,
    sample_viewpoints,
)

Points = NDArray[np.float32]
Measure = Callable[[Viewpoint], Points]
"""Takes a measurement: end points `(n, 3)` in the map frame."""
Box = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Lowest and highest corner [m], map frame."""


@dataclass(frozen=True, slots=True)
class ExplorationParameters:
    """How viewpoints are weighed."""

    alpha: float = 0.7
    """Weight of information [nat] against time [s] (eq. 5.24)."""
    threshold: float = 2.0
    """tau: the exploration ends when no viewpoint's utility is higher."""
    sampling_radius_m: float = 2.0
    viewpoints: int = 40
    """Sampled in each step."""
    gain_columns: int = 48
    """Beams a row by which the gain is estimated."""
    gain_rows: int = 36
    resolution_m: float = 0.02
    """Voxel size of the map that gains and ways are computed in."""
    region_height_m: float = 0.3
    """The space over a table that belongs to it."""
    most_measurements: int = 20
    """After the first look around."""


@dataclass
class Model:
    """What is known so far: M_t."""

    map: OctreeMap
    hierarchy: MapHierarchy
    measurements: int = 0

    def update(
        self, points_m: Points, viewpoint: Viewpoint, parameters: TabletopParameters
    ) -> None:
        """updateModel."""
        origin = np.array(viewpoint.position_m)
        self.map.insert_scan(origin, points_m)
        self.hierarchy.update(segment(points_m, parameters, seed=self.measurements), origin)
        merge_parts(self.hierarchy)
        self.measurements += 1


@dataclass(frozen=True, slots=True)
class Candidate:
    """A viewpoint with what it promises."""

    viewpoint: Viewpoint
    cost_s: float
    gain_nat: float
    utility: float


Choice = Callable[["Step", np.random.Generator], Candidate | None]
"""Picks the next viewpoint, or ends the exploration."""


@dataclass(frozen=True, slots=True)
class Step:
    """One turn of the loop."""

    model: Model
    region_m: Box
    """The space over the table."""
    candidates: tuple[Candidate, ...]
    chosen: Candidate | None = None


def highest_utility(threshold: float) -> Choice:
    """The thesis's choice (eq. 5.25): the best trade of information against time, above tau."""

    def choose(step: Step, _: np.random.Generator) -> Candidate | None:
        best = max(step.candidates, key=lambda candidate: candidate.utility)
        return best if best.utility > threshold else None

    return choose


def at_random(step: Step, random: np.random.Generator) -> Candidate | None:
    """Any viewpoint that can be reached, for comparison."""
    return step.candidates[int(random.integers(len(step.candidates)))]


def nearest_frontier(fewest_voxels: int = 20) -> Choice:
    """The nearest viewpoint that sees some frontier: free voxels beside unknown ones (Yamauchi,
    1997), for comparison."""

    def choose(step: Step, _: np.random.Generator) -> Candidate | None:
        frontier = frontier_voxels(step.model.map, step.region_m)
        for candidate in sorted(step.candidates, key=lambda candidate: candidate.cost_s):
            if len(frontier) == 0:
                return None
            eye = np.array(candidate.viewpoint.position_m)
            towards = eye - frontier
            # A line of sight that nothing occupied cuts; space near the eye may be unknown.
            ends, positions = step.model.map.cast_rays(
                frontier, towards, float(np.linalg.norm(towards, axis=1).max()), True
            )
            reach = np.linalg.norm(positions - frontier, axis=1)
            seen = (ends != 0) | (reach >= np.linalg.norm(towards, axis=1))
            if seen.sum() >= fewest_voxels:
                return candidate
        return None

    return choose


def frontier_voxels(octree: OctreeMap, region_m: Box) -> NDArray[np.float64]:
    """Centres `(n, 3)` of the free voxels of a region that touch an unknown one by a face."""
    centres, log_odds = octree.known_voxels(region_m)
    free = centres[log_odds < 0]
    steps = octree.resolution_m * np.concatenate([np.eye(3), -np.eye(3)])
    beside = free[:, None, :] + steps
    unknown = np.isnan(octree.log_odds(beside.reshape(-1, 3))).reshape(len(free), 6)
    low, high = (np.array(corner) for corner in region_m)
    within = ((beside >= low) & (beside <= high)).all(axis=2)
    found: NDArray[np.float64] = free[(unknown & within).any(axis=1)]
    return found


def region_entropy(octree: OctreeMap, region_m: Box) -> float:
    """Entropy of the voxels of a region [nat] (eq. 5.28); unknown ones have ln 2 each."""
    _, log_odds = octree.known_voxels(region_m)
    p = 1 / (1 + np.exp(-log_odds))
    known = float(-(p * np.log(p) + (1 - p) * np.log(1 - p)).sum())
    return known + float(np.log(2)) * (region_voxels(octree, region_m) - len(log_odds))


def region_voxels(octree: OctreeMap, region_m: Box) -> int:
    """How many voxels have their centre in a region."""
    low, high = (np.array(corner) / octree.resolution_m for corner in region_m)
    return int(np.prod(np.floor(high - 0.5) - np.ceil(low - 0.5) + 1))


@dataclass(frozen=True)
class Explorer:
    """A robot that explores the nearest table."""

    sensor: DepthSensor
    measure: Measure
    platform: Platform = field(default_factory=Platform)
    parameters: ExplorationParameters = field(default_factory=ExplorationParameters)
    segmentation: TabletopParameters = field(default_factory=TabletopParameters)
    resolutions_m: tuple[float, float, float] = (0.05, 0.01, 0.005)
    """Of the model's background, tables and objects."""

    def explore(self, start: Sequence[Viewpoint], choose: Choice, seed: int = 0) -> Iterator[Step]:
        """Measures, weighs, drives and measures again; gives every step, the last without a choice.

        Args:
            start: views from the first place, taken one after the other.

        Raises:
            NoWayError: no table in sight of the start, or no viewpoint can be reached.
        """
        random = np.random.default_rng(seed)
        background, table, thing = self.resolutions_m
        model = Model(
            OctreeMap(self.parameters.resolution_m),
            tabletop_hierarchy({"background": background, "table": table, "object": thing}),
        )
        for here in start:
            model.update(self.measure(here), here, self.segmentation)
        target = nearest_table(model.hierarchy, here.position_m[:2], frozenset())
        if target is None:
            raise NoWayError("no table was seen from the start")
        while True:
            step = self.weigh(model, target.id, here, random)
            chosen = None
            if model.measurements < len(start) + self.parameters.most_measurements:
                chosen = choose(step, random)
            yield Step(model, step.region_m, step.candidates, chosen)
            if chosen is None:
                return
            here = chosen.viewpoint
            model.update(self.measure(here), here, self.segmentation)

    def weigh(self, model: Model, table: int, here: Viewpoint, random: np.random.Generator) -> Step:
        """Samples viewpoints around a table (Algorithm 6) and computes their utility (eq. 5.24)."""
        parameters = self.parameters
        boxes = [node.box() for node in model.hierarchy.nodes() if node.id == table]
        if not boxes or boxes[0] is None:
            raise NoWayError("the table is gone")
        region_m = space_over(boxes[0], parameters.region_height_m)
        (x, y), z = np.mean(region_m, axis=0)[:2].tolist(), region_m[0][2]
        grid = traversability(model.map, Passage(height_m=self.platform.sensor_height_m))
        ways = Ways(grid, self.platform, here.position_m[:2])
        viewpoints = sample_viewpoints(
            ways, (x, y, z), parameters.sampling_radius_m, parameters.viewpoints, random
        )
        costs = [ways.travel_time_s(viewpoint.position_m[:2]) for viewpoint in viewpoints]
        reached = [
            (v, cost) for v, cost in zip(viewpoints, costs, strict=True) if np.isfinite(cost)
        ]
        if not reached:
            raise NoWayError("no viewpoint around the table can be reached")
        gains = self.gains_nat(model.map, [viewpoint for viewpoint, _ in reached], region_m)
        alpha = parameters.alpha
        return Step(
            model,
            region_m,
            tuple(
                Candidate(viewpoint, cost, gain, alpha * gain - (1 - alpha) * cost)
                for (viewpoint, cost), gain in zip(reached, gains.tolist(), strict=True)
            ),
        )

    def gains_nat(
        self, octree: OctreeMap, viewpoints: list[Viewpoint], region_m: Box
    ) -> NDArray[np.float64]:
        """I(M_t; v) of each viewpoint `(v,)` (eq. 5.30)."""
        coarse = DepthSensor(
            self.sensor.horizontal_field_rad,
            self.sensor.vertical_field_rad,
            self.parameters.gain_columns,
            self.parameters.gain_rows,
        )
        beams = np.stack([coarse.directions(v.yaw_rad, v.pitch_rad) for v in viewpoints])
        origins = np.array([v.position_m for v in viewpoints])
        return octree.information_gain(origins, beams, self.sensor.range_m, region_m)


def space_over(box: OrientedBox, height_m: float) -> Box:
    """The space over a table up to a height, along the axes of the map frame."""
    corners = np.stack(np.meshgrid(*[[-1, 1]] * 3), axis=-1).reshape(-1, 3) * box.half_extents_m
    corners = box.centre_m + corners @ box.axes.T
    low, high = corners.min(axis=0), corners.max(axis=0)
    return (
        (float(low[0]), float(low[1]), float(box.centre_m[2])),
        (float(high[0]), float(high[1]), float(box.centre_m[2]) + height_m),
    )
