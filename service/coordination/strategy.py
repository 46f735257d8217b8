"""What a coordination strategy is given and what it answers.

A strategy is a pure function of a frozen `Situation`, so that it can run in any thread or process
and be tested without a service.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from domains.formulation import Assignment
from domains.mission_state import MissionState
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.messages.base import Position
from service.messages.instruction import Instruction
from service.messages.mission import PlanningMessage
from service.messages.plan import PlanStep
from service.messages.report import Command


@dataclass(frozen=True)
class Situation:
    """All that a decision may depend on."""

    domain: str
    """Name of the formulation."""
    state: MissionState
    grid: GridMap
    """The map without blockades; those known are in `state`."""
    models: Mapping[str, RobotModel]
    """Robot model of each robot type."""
    planning: PlanningMessage
    trigger: str
    """The facts that ask for a decision, for the log."""
    domain_text: str | None = None
    """The PDDL to plan with; None for that of the formulation's folder."""
    hurried: bool = False
    """Others wait for the planners: what needs no search is decided without one."""
    version: int = 0
    """Changes whenever the grid does."""
    in_force: tuple[PlanStep, ...] = ()
    """The plan in force, starts in mission time [s]; empty if it can no longer be relied on."""
    done: tuple[Command, ...] = ()
    """The commands carried out since it came into force, in order."""
    avoid: frozenset[tuple[str, str]] = frozenset()
    """Robots and places that do not go together."""
    priorities: Mapping[str, int] = field(default_factory=dict)
    """Targets to visit before others, by id; higher goes first, 0 where none is given."""
    deadlines_s: Mapping[str, float] = field(default_factory=dict)
    """Mission time by which a target is to be visited [s]."""
    exploring: bool = False
    """The targets are where the known map ends; more will be found behind them."""
    communication_range_m: float | None = None
    """Robots further apart, and not linked through others, cannot be coordinated; None for all."""
    commands_ahead: int = 0
    """How many further orders each robot gets for when it is out of contact."""
    only_map_changed: bool = False
    """Nothing but the map has changed since the decision before."""
    going: Mapping[str, str] = field(default_factory=dict)
    """Where robots are on their way to, by robot."""
    restless: int = 0
    """How often orders have changed since anything came to be known or was done."""
    target_places_m: Mapping[str, Position] = field(default_factory=dict)
    """Where the targets that the plan in force knows were last, also those that are gone since."""
    instructions: tuple[tuple[str, Instruction], ...] = ()
    """All that people have said, with ids, for remarks."""

    @property
    def explores_with_carriers(self) -> bool:
        """Whether plans are made for what is known so far, and more of it will be carrying."""
        return self.exploring and bool(self.state.capacities)


@dataclass(frozen=True, slots=True)
class Proposal:
    """What a strategy wants the robots to do."""

    assignments: tuple[Assignment, ...]
    """At most one a robot; a robot without one waits."""
    reason: str
    then: Mapping[str, tuple[Assignment, ...]] = field(default_factory=dict)
    """What robots do after their assignments if nobody can tell them anything else, by robot."""
    steps: tuple[PlanStep, ...] = ()
    """The plan behind the assignments, starts in mission time [s]."""
    validated: bool = False
    keeps_plan: bool = False
    """The plan in force is as good: its steps stay, the assignments are its next ones."""
    unreachable: frozenset[str] = frozenset()
    """Targets that the team cannot visit as far as is known."""
    remarks: Mapping[str, str] = field(default_factory=dict)
    """Why an instruction cannot be obeyed, by its id."""


class Strategy(Protocol):
    """Coordinates a team."""

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """What every robot does next.

        Args:
            memory: what attachments keep between the decisions of a mission; it changes no answer.

        Raises:
            NoPlanError: nothing can be done, as far as is known.
        """
        ...


class NoPlanError(Exception):
    """A strategy found nothing that the team can do; says why."""
