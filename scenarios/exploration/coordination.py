"""Lets a strategy of the service coordinate a kinematic exploration, without HTTP in between."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from math import dist
from typing import Self

import numpy as np
from numpy.typing import NDArray

from domains.mission_state import MissionState, RobotState, Target
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.exploration.reach import ReachableSpace, reachable_space
from service.coordination.exploration.targets import (
    ExplorationTarget,
    exploration_targets,
    named,
    unknown_beside,
)
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.messages.mission import PlanningMessage
from simulator.kinematic_exploration import Errand, TeamView

ROBOT_TYPE = "explorer"
SAME_TARGET_M = 3.0
"""a frontier this near to one of before carries on its name"""
_PURPOSE_REACH_M = 1.0
_THERE_M = 0.5


@dataclass
class StrategyAtWork:
    """Extracts the targets, asks the strategy, and turns its orders into errands.

    The targets are the same for every strategy. A target that a robot has been to and that still
    borders on unknown cells is given up: nothing more is to be seen from there.
    """

    strategy: Strategy
    model: RobotModel
    planning: PlanningMessage = field(default_factory=PlanningMessage)
    decision_cpu_s: list[float] = field(default_factory=list)
    target_counts: list[int] = field(default_factory=list)
    _memory: Memory = field(default_factory=Memory)
    _given_up: NDArray[np.bool_] | None = None
    _known: dict[str, tuple[float, float]] = field(default_factory=dict)
    _number: int = 1
    _sent: dict[str, tuple[tuple[float, float], NDArray[np.int64]]] = field(default_factory=dict)
    _proposal: Proposal | None = None

    def __call__(self, view: TeamView) -> Mapping[str, Errand]:
        """The errands of one cluster of robots."""
        grid = GridMap(view.grid.cells, view.grid.resolution_m, view.grid.origin_m)
        targets = self._targets(view, grid)
        self.target_counts.append(len(targets))
        if not targets:
            return {}
        situation = self._situation(view, grid, targets)
        begin_s = time.process_time()
        try:
            proposal = self.strategy.propose(situation, self._memory)
        except NoPlanError:
            return {}
        finally:
            self.decision_cpu_s.append(time.process_time() - begin_s)
        self._proposal = proposal
        space = reachable_space(grid, self.model, (), self._memory)
        errands = {}
        for order in proposal.assignments:
            target = targets.get(order.location or "")
            if target is not None:
                errand = self._errand(view.positions_m[order.robot], target, grid, space)
                if errand is not None:
                    errands[order.robot] = errand
                    at = (float(errand.path_m[-1, 0]), float(errand.path_m[-1, 1]))
                    self._sent[order.robot] = (at, errand.purpose)
        return errands

    @property
    def known_targets_m(self) -> Mapping[str, tuple[float, float]]:
        """Where the targets of the last decision are, by name."""
        return self._known

    def take_over(self, others: Sequence[Self], members: Collection[str]) -> None:
        """Goes on with what other planners knew, for some of their robots."""
        for other in others:
            if other._given_up is not None:
                known = self._given_up
                self._given_up = other._given_up | (False if known is None else known)
            # What two planners named alike is not the same frontier.
            self._known = {**other._known, **self._known}
            self._number = max(self._number, other._number)
            self._sent |= {robot: sent for robot, sent in other._sent.items() if robot in members}
        if len(others) == 1:
            self._proposal = others[0]._proposal

    def _targets(self, view: TeamView, grid: GridMap) -> dict[str, ExplorationTarget]:
        if self._given_up is None:
            self._given_up = np.zeros(grid.cells.shape, dtype=np.bool_)
        for robot, position_m in view.positions_m.items():
            if robot in self._sent and dist(self._sent[robot][0], position_m) < _THERE_M:
                purpose = self._sent.pop(robot)[1]
                self._given_up.ravel()[purpose[grid.cells.ravel()[purpose] < 0]] = True
        cells = [_cell(grid, position_m) for position_m in view.positions_m.values()]
        found = exploration_targets(
            grid,
            {ROBOT_TYPE: self.model},
            {ROBOT_TYPE: cells},
            memory=self._memory,
            given_up=self._given_up,
        )
        targets = named(
            found, grid, self._known, next_number=self._number, same_within_m=SAME_TARGET_M
        )
        self._number += sum(name not in self._known for name in targets)
        positions = grid.centres_m([target.cell for target in targets.values()])
        self._known = {
            name: (float(x), float(y)) for name, (x, y) in zip(targets, positions, strict=True)
        }
        return targets

    def _situation(
        self, view: TeamView, grid: GridMap, targets: Mapping[str, ExplorationTarget]
    ) -> Situation:
        kept = self._proposal
        return Situation(
            domain="disaster",
            state=MissionState(
                time_s=view.time_s,
                robots=tuple(
                    RobotState(name, ROBOT_TYPE, position_m)
                    for name, position_m in view.positions_m.items()
                ),
                targets=tuple(Target(name, self._known[name]) for name in targets),
            ),
            grid=grid,
            models={ROBOT_TYPE: self.model},
            planning=self.planning,
            trigger="exploration",
            exploring=True,
            version=len(self.decision_cpu_s),
            in_force=kept.steps if kept is not None and kept.validated else (),
        )

    @staticmethod
    def _errand(
        position_m: tuple[float, float],
        target: ExplorationTarget,
        grid: GridMap,
        space: ReachableSpace,
    ) -> Errand | None:
        way = space.way(_cell(grid, position_m), target.cell)
        if not len(way):
            return None
        path_m = np.concatenate([np.array([position_m]), grid.centres_m(way)])
        reach_cells = round(_PURPOSE_REACH_M / grid.resolution_m)
        return Errand(path_m, unknown_beside(grid, target.frontier_cell, reach_cells))


def _cell(grid: GridMap, position_m: tuple[float, float]) -> int:
    cell = grid.cell_at(position_m)
    if cell is None:
        raise ValueError(f"{position_m} lies outside the map")
    return cell
