"""What happened in a mission: the one source of the JSON file, the closing table and the report.

Positions are metres in the map frame, times seconds since the mission began.
"""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass
from typing import Any

Point = tuple[float, float]


@dataclass(frozen=True)
class Activity:
    """A robot doing one thing from `start_s` to `end_s`."""

    kind: str
    """`explore`, `move`, `clear`, `dock`, `undock`, `wait`, `docked`, `failed`"""
    location: str | None
    start_s: float
    end_s: float


@dataclass(frozen=True)
class RobotRecord:
    """One robot's mission."""

    id: str
    type: str
    trail: tuple[tuple[float, float, float], ...]
    """`(time_s, x_m, y_m)`"""
    activities: tuple[Activity, ...]
    distance_m: float

    def spent_s(self, *kinds: str) -> float:
        """Time spent with activities of these kinds."""
        return sum(a.end_s - a.start_s for a in self.activities if a.kind in kinds)


@dataclass(frozen=True)
class TargetRecord:
    """A target and who visited it."""

    id: str
    position_m: Point
    visited_by: str | None = None
    visited_at_s: float | None = None


@dataclass(frozen=True)
class BlockadeRecord:
    """A blockade, known to the fleet or not."""

    id: str
    segment_m: tuple[Point, Point]
    clear_duration_s: float
    seen_at_s: float | None = None
    cleared_by: str | None = None
    cleared_at_s: float | None = None


@dataclass(frozen=True)
class DecisionRecord:
    """Something the coordination decided, and why."""

    time_s: float
    revision: int
    kind: str
    reason: str

    @property
    def for_blockade(self) -> bool:
        """Whether a blockade that somebody has just seen is the reason."""
        return re.search(r"\bblockade \S+ seen\b", self.reason) is not None


@dataclass(frozen=True)
class PlannedStep:
    """A step of a plan; `start_s` counts from the beginning of the mission."""

    action: str
    arguments: tuple[str, ...]
    start_s: float
    duration_s: float


@dataclass(frozen=True)
class PlanRecord:
    """A plan that was in force from `time_s` on."""

    revision: int
    time_s: float
    makespan_s: float
    """mission time at which its last step ends"""
    validated: bool
    steps: tuple[PlannedStep, ...]


@dataclass(frozen=True)
class MissionRecord:
    """A mission from start to end."""

    scenario: str
    strategy: str
    domain: str
    seed: int
    version: str
    status: str
    status_reason: str
    duration_s: float
    wall_s: float
    planning_s: float
    """part of `wall_s` spent waiting for the service"""
    map_size_m: Point
    sealed_fraction: float
    wall_collisions: int
    robot_collisions: int
    blockade_crossings: int
    """moves through an uncleared blockade; zero in a sound simulation"""
    replans: int
    robots: tuple[RobotRecord, ...]
    targets: tuple[TargetRecord, ...]
    blockades: tuple[BlockadeRecord, ...]
    decisions: tuple[DecisionRecord, ...]
    plans: tuple[PlanRecord, ...]
    mission: str | None = None
    """its id, if this is what a service's log tells: nobody knows of touches or hidden blockades"""
    pose_error_m: Point | None = None
    """by how much the robots' beliefs of where they are were off, on average and at most; None
    without odometry noise"""
    known_share: float | None = None
    """of the free cells of a building that was to be explored, those known in the end"""

    @property
    def completed(self) -> bool:
        """Whether every target was visited."""
        return self.status == "completed"

    @property
    def targets_left(self) -> int:
        """Targets that nobody visited."""
        return sum(target.visited_at_s is None for target in self.targets)

    @property
    def blockades_seen(self) -> int:
        """Blockades the fleet learned of."""
        return sum(blockade.seen_at_s is not None for blockade in self.blockades)

    @property
    def blockades_cleared(self) -> int:
        """Blockades that were removed."""
        return sum(blockade.cleared_at_s is not None for blockade in self.blockades)

    @property
    def distance_m(self) -> float:
        """What all robots drove together."""
        return sum(robot.distance_m for robot in self.robots)

    @property
    def plans_accepted(self) -> int:
        """Plans in force that the validator accepted."""
        return sum(plan.validated for plan in self.plans)

    @property
    def one_step_plans(self) -> int:
        """Plans in force that are one-step orders of a baseline or a fallback, not validated."""
        return len(self.plans) - self.plans_accepted

    @property
    def replans_for_blockades(self) -> int:
        """Decisions whose reason is a blockade that somebody has just seen."""
        return sum(decision.for_blockade for decision in self.decisions)

    def to_json(self) -> dict[str, Any]:
        """A summary first, then everything."""
        summary = {
            "targets_left": self.targets_left,
            "blockades_seen": self.blockades_seen,
            "blockades_cleared": self.blockades_cleared,
            "distance_m": round(self.distance_m, 2),
            "plans_in_force": len(self.plans),
            "plans_accepted": self.plans_accepted,
            "replans_for_blockades": self.replans_for_blockades,
        }
        return {"completed": self.completed, **summary, **asdict(self)}
