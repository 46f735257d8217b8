"""Strategies of the service that assign one exploration target to each robot at every event."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from domains.formulation import Assignment, OrderKind
from domains.mission_state import Activity, RobotState
from semantic_attachments.contract import Memory
from semantic_attachments.world import Blockade, GridMap
from service.coordination.exploration.communication_clusters import communication_clusters
from service.coordination.exploration.problem import Assigner, ExplorationProblem
from service.coordination.exploration.reach import reachable_space
from service.coordination.one_step_disaster import (
    being_cleared,
    clear_nearest,
    free,
    steps_of,
    wait_at_blockades,
)
from service.coordination.strategy import NoPlanError, Proposal, Situation
from service.coordination.travel import Travel

CLEARER = "clearer"
"""Robots of this type clear blockades and do not explore (the disaster domain)."""
AT_WORK = (Activity.CLEARING, Activity.DOCKING, Activity.UNDOCKING)


@dataclass(frozen=True)
class Exploring:
    """Sends every free robot to the target that an assigner gives it."""

    assigner: Assigner
    name: str

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """One exploration order a robot; robots that are out of touch with one another are
        coordinated apart, each cluster by a planner of its own (Wurm, end of section 2.5).
        """
        state = situation.state
        free_robots = [robot for robot in state.robots if robot.activity is Activity.FREE]
        robots = [robot for robot in free_robots if robot.type != CLEARER]
        clusters = communication_clusters(
            [robot.position_m for robot in robots], situation.communication_range_m
        )
        orders: list[Assignment] = []
        for cluster in clusters:
            orders += self._assigned([robots[index] for index in cluster], situation, memory)
        if state.blockades:
            orders += _about_blockades(situation, memory, {order.robot for order in orders})
        if not orders and not any(robot.activity in AT_WORK for robot in state.robots):
            raise NoPlanError("no robot can reach a target")
        orders.sort(key=lambda order: order.robot)
        return Proposal(
            assignments=tuple(orders),
            reason=f"{self.name}: {len(orders)} of {len(free_robots)} robots",
            steps=steps_of(orders, situation),
        )

    def _assigned(
        self, robots: list[RobotState], situation: Situation, memory: Memory
    ) -> list[Assignment]:
        problem = problem_of(robots, situation, memory)
        targets = situation.state.targets
        return [
            Assignment(
                robots[row].id,
                OrderKind.EXPLORE,
                targets[column].id,
                expected_duration_s=float(problem.costs_s[row, column]),
            )
            for row, column in self.assigner.assign(problem).items()
            if np.isfinite(problem.costs_s[row, column])
        ]


def _about_blockades(situation: Situation, memory: Memory, ordered: set[str]) -> list[Assignment]:
    """Clearers go to the nearest blockades; explorers whose targets are all sealed wait there."""
    travel = Travel(situation, memory)
    clearers = free(situation, CLEARER)
    sealed = [robot for robot in free(situation, "explorer") if robot not in ordered]
    targets = [target.id for target in situation.state.targets]
    return [
        *clear_nearest(situation, travel, clearers, taken=being_cleared(situation)),
        *wait_at_blockades(situation, travel, sealed, targets, memory),
    ]


def problem_of(
    robots: list[RobotState], situation: Situation, memory: Memory
) -> ExplorationProblem:
    """The assignment problem of some robots and all targets of a situation."""
    grid, models = situation.grid, situation.models
    targets = situation.state.targets
    robot_cells = _cells(grid, {robot.id: robot.position_m for robot in robots})
    target_cells = _cells(grid, {target.id: target.position_m for target in targets})
    blockades = tuple(
        Blockade(b.id, b.segment_m, b.clear_duration_s) for b in situation.state.blockades
    )
    costs_s = np.full((len(robots), len(targets)), np.inf)
    for robot_type in sorted({robot.type for robot in robots}):
        rows = [row for row, robot in enumerate(robots) if robot.type == robot_type]
        space = reachable_space(grid, models[robot_type], blockades, memory)
        lengths_m = space.lengths_m(robot_cells[rows].tolist(), target_cells.tolist())
        costs_s[rows] = lengths_m / models[robot_type].speed_m_s
    for row, robot in enumerate(robots):
        for column, target in enumerate(targets):
            if (robot.id, target.id) in situation.avoid:
                costs_s[row, column] = np.inf
    used = [models[robot.type] for robot in robots]
    return ExplorationProblem(
        grid=grid,
        robot_cells=robot_cells,
        target_cells=target_cells,
        costs_s=costs_s,
        sensor_range_m=min((model.sensor_range_m for model in used), default=1.0),
        speed_m_s=max((model.speed_m_s for model in used), default=1.0),
    )


def _cells(grid: GridMap, positions_m: Mapping[str, tuple[float, float]]) -> NDArray[np.int64]:
    """(n,) cells of positions.

    Raises:
        NoPlanError: a position lies outside the map.
    """
    found = []
    for name, position_m in positions_m.items():
        cell = grid.cell_at(position_m)
        if cell is None:
            raise NoPlanError(f"{name} is outside the map")
        found.append(cell)
    return np.array(found, dtype=np.int64)
