"""What an assignment of robots to exploration targets is decided on."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.world import GridMap


@dataclass(frozen=True)
class ExplorationProblem:
    """Robots that need a target, targets on frontiers, and the ways between them."""

    grid: GridMap
    """The map as known so far."""
    robot_cells: NDArray[np.int64]
    """(robots,) where they are, `row * width + column`."""
    target_cells: NDArray[np.int64]
    """(targets,) where the targets are."""
    costs_s: NDArray[np.float64]
    """(robots, targets) travel time; infinite where a robot cannot go (equation 2.4)."""
    sensor_range_m: float
    """The shortest of the robots' sensor ranges."""

    speed_m_s: float
    """The speed of the fastest robot."""

    @property
    def target_positions_m(self) -> NDArray[np.float64]:
        """(targets, 2) in the map frame."""
        return self.grid.centres_m(self.target_cells)


class Assigner(Protocol):
    """Assigns robots to exploration targets."""

    def assign(self, problem: ExplorationProblem) -> Mapping[int, int]:
        """Target of each robot that gets one, both by index."""
        ...
