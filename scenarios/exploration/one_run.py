"""One exploration: a building, a team, a start, a strategy."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenarios.exploration.buildings import Building
from scenarios.exploration.coordination import ROBOT_TYPE, StrategyAtWork
from scenarios.exploration.planner_per_cluster import PlannerPerCluster
from scenarios.maps.free_space import components
from semantic_attachments._core import Region
from semantic_attachments.world import RobotModel
from service.coordination.strategy import Strategy
from service.messages.mission import PlanningMessage
from simulator.kinematic_exploration import (
    Decide,
    ExplorationResult,
    KinematicExploration,
    KinematicParameters,
)

RADIUS_M = 0.25
Pose = tuple[float, float, float]


@dataclass(frozen=True)
class RunParameters:
    """What all runs of an experiment have in common."""

    kinematics: KinematicParameters = field(default_factory=KinematicParameters)
    planning: PlanningMessage = field(
        default_factory=lambda: PlanningMessage(node_limit=2000, time_limit_s=30.0)
    )
    """limited by nodes, so that runs repeat; the time limit is there for the unforeseen"""
    start_spacing_m: float = 0.8


def explore(
    building: Building,
    robots: int,
    seed: int,
    strategy: Strategy,
    parameters: RunParameters | None = None,
    *,
    watched: Callable[[PlannerPerCluster], Decide] | None = None,
) -> tuple[ExplorationResult, PlannerPerCluster]:
    """Explores a building; the robots start side by side at a place drawn by the seed.

    Args:
        watched: puts somebody between the strategy and the robots who looks on.
    """
    parameters = parameters or RunParameters()
    kinematics = parameters.kinematics
    model = RobotModel(
        type=ROBOT_TYPE,
        radius_m=RADIUS_M,
        speed_m_s=kinematics.speed_m_s,
        sensor_range_m=kinematics.sensor_range_m,
    )
    planning = replace_seed(parameters.planning, seed)
    at_work = PlannerPerCluster(lambda: StrategyAtWork(strategy, model, planning))
    starts = gathered_starts(building, robots, seed, parameters.start_spacing_m)
    named = {f"robot_{number:03d}": pose for number, pose in enumerate(starts, 1)}
    truth = replace(building.truth, cells=reachable_only(building))
    simulation = KinematicExploration(truth, named, kinematics)
    return simulation.run(at_work if watched is None else watched(at_work)), at_work


def replace_seed(planning: PlanningMessage, seed: int) -> PlanningMessage:
    """The same effort, with a run's seed."""
    return planning.model_copy(update={"seed": seed})


def reachable_only(building: Building) -> NDArray[np.int8]:
    """The building without free cells that no robot can see from where it gets to."""
    cells = building.truth.cells.copy()
    free = cells == 0
    reached = components(cells, building.truth.resolution_m, RADIUS_M) == 1
    seen = np.isfinite(Region(free).geodesic(np.flatnonzero(reached).astype(np.uint32)).lengths())
    cells[free & ~seen] = -1
    return cells


def gathered_starts(building: Building, robots: int, seed: int, spacing_m: float) -> list[Pose]:
    """Poses side by side: a place drawn uniformly, then the nearest places by way.

    Raises:
        ValueError: the building has no room for so many robots.
    """
    grid = building.truth
    inside = components(grid.cells, grid.resolution_m, RADIUS_M + grid.resolution_m) == 1
    cells = np.flatnonzero(inside)
    random = Random(f"start {seed}")
    first = int(cells[random.randrange(len(cells))])
    lengths = Region(inside).geodesic([first]).lengths().ravel()
    order = cells[np.argsort(lengths[cells], kind="stable")]
    rows, columns = np.divmod(order, grid.cells.shape[1])
    left = np.stack([columns, rows], axis=1) * grid.resolution_m
    apart = np.isfinite(lengths[order])
    poses: list[Pose] = []
    while len(poses) < robots:
        if not apart.any():
            raise ValueError(f"{building.name} has room for {len(poses)} of {robots} robots")
        x, y = left[int(np.argmax(apart))]
        apart &= np.hypot(left[:, 0] - x, left[:, 1] - y) >= spacing_m
        half = 0.5 * grid.resolution_m
        heading = random.uniform(-np.pi, np.pi)
        poses.append(
            (float(x + grid.origin_m[0] + half), float(y + grid.origin_m[1] + half), heading)
        )
    return poses


def row_of(
    building: Building,
    robots: int,
    seed: int,
    strategy: Strategy,
    *,
    strategy_name: str,
    parameters: RunParameters | None = None,
) -> dict[str, Any]:
    """What is kept of a run, in the columns that suites use."""
    begin_s = time.process_time()
    result, at_work = explore(building, robots, seed, strategy, parameters)
    driven = list(result.driven_m.values())
    complete = result.completed and result.known_share > 0.9
    return {
        "map": building.name,
        "map_seed": building.map_seed,
        "team": f"{robots} robots",
        "robots": robots,
        "seed": seed,
        "strategy": strategy_name,
        "status": "completed" if complete else "incomplete",
        "duration_s": result.duration_s,
        "time_to_99_s": _time_to(result, 0.99),
        "driven_m": sum(driven),
        "longest_drive_m": max(driven),
        "known_share": round(result.known_share, 5),
        "decisions": result.decisions,
        "decision_cpu_ms": round(1e3 * float(np.mean(at_work.decision_cpu_s or [0.0])), 3),
        "most_targets": max(at_work.target_counts, default=0),
        "clusters": result.clusters,
        "cpu_s": round(time.process_time() - begin_s, 3),
    }


def _time_to(result: ExplorationResult, share: float) -> float:
    """When so much of what is known in the end was known [s], to ten seconds."""
    times, shares = result.known_share_over_time.T
    enough = np.flatnonzero(shares >= share * result.known_share)
    return float(times[enough[0]]) if len(enough) else inf
