"""A mission: the state that its events add up to (see `history`)."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from service.coordination.fleet_robot import FleetRobot
from service.coordination.mission_map import MissionMap
from service.messages.base import Position
from service.messages.instruction import Instruction
from service.messages.mission import CreateMission
from service.messages.plan import Decision, PlanStep
from service.messages.report import Command, MissionStatus
from service.messages.resource import UsedResource

DECISIONS_KEPT = 200


@dataclass(slots=True)
class MissionTarget:
    """A place to visit."""

    id: str
    position_m: Position
    visited_by: str | None = None
    visited_at_s: float | None = None
    removed: bool = False
    is_frontier: bool = False
    """Found where the known map ends, in an exploration."""
    visited_from_m: Position | None = None
    """Where the robot that visited it was."""

    @property
    def is_open(self) -> bool:
        """Whether it still has to be visited."""
        return self.visited_by is None and not self.removed


@dataclass(slots=True)
class GivenInstruction:
    """An instruction in force."""

    id: str
    instruction: Instruction
    given_at_s: float
    remark: str = ""
    """Why the plan in force cannot obey."""


@dataclass(slots=True)
class MissionBlockade:
    """A blockade somebody has sensed."""

    id: str
    segment_m: tuple[Position, Position]
    clear_duration_s: float
    seen_at_s: float
    cleared_by: str | None = None
    cleared_at_s: float | None = None


@dataclass(frozen=True, slots=True)
class PlanInForce:
    """The plan that the commands come from; starts in mission time [s]."""

    steps: tuple[PlanStep, ...]
    validated: bool
    revision: int
    adopted_at_s: float

    @property
    def end_s(self) -> float:
        """Mission time at which the last step ends."""
        return max((step.start_s + (step.duration_s or 0.0) for step in self.steps), default=0.0)


@dataclass(frozen=True, slots=True)
class Failures:
    """The commands to one place that one robot gave up."""

    count: int
    news: int
    """`Mission.news` at the last of them: what has happened since, it did not reckon with."""


@dataclass(slots=True)
class Mission:
    """The aggregate; built and changed by `history` alone."""

    id: str
    request: CreateMission
    robots: dict[str, FleetRobot]
    targets: dict[str, MissionTarget]
    map: MissionMap
    domain_text: str | None = None
    """The PDDL that it plans with; None for that of the formulation's folder."""
    resources: tuple[UsedResource, ...] = ()
    """Versions of domains and maps that it keeps until it ends."""
    blockades: dict[str, MissionBlockade] = field(default_factory=dict)
    status: MissionStatus = "queued"
    status_reason: str = "waiting for the fleet's first report"
    time_s: float = 0.0
    sequence: int = -1
    missing: set[int] = field(default_factory=set)
    """Sequence numbers below `sequence` that never arrived."""
    revision: int = 0
    plannings: int = 0
    """Times that a strategy was asked."""
    plan: PlanInForce | None = None
    plan_disturbed: bool = False
    """Something has happened that the plan in force does not reckon with."""
    disturbed_by: int = 0
    """Number of the event that disturbed the plan last."""
    hopeless_since_s: float | None = None
    """Nothing has happened since a strategy found that the team can do nothing."""
    target_places_m: dict[str, Position] = field(default_factory=dict)
    """Where the targets that the plan in force knows were last, also those that are gone since."""
    done: list[Command] = field(default_factory=list)
    """Commands carried out since the plan in force was begun to be made, in order."""
    commands: dict[str, Command] = field(default_factory=dict)
    """The command in force of each robot."""
    issued_at_s: dict[str, float] = field(default_factory=dict)
    orders: dict[str, Command] = field(default_factory=dict)
    """Every command ever issued that is not closed: a late `finished` is still a fact."""
    ahead: set[str] = field(default_factory=set)
    """Those among the orders that robots carry out only when they are out of contact."""
    closed: set[str] = field(default_factory=set)
    """Commands reported as finished or failed."""
    barred: set[str] = field(default_factory=set)
    """Commands in force whose path leads through what was sensed to be occupied since."""
    failures: dict[tuple[str, str], Failures] = field(default_factory=dict)
    """The commands that a robot gave up, by robot and place."""
    news: int = 0
    """How often something that matters for what robots can do has come to be known or done."""
    restless: int = 0
    """How often the orders have changed since there were news."""
    instructions: dict[str, GivenInstruction] = field(default_factory=dict)
    frontiers_named: int = 0
    """Exploration targets that have had a name so far."""
    decisions: list[Decision] = field(default_factory=list)
    events: int = 0

    @property
    def is_over(self) -> bool:
        """Whether it reached its terminal state."""
        return self.status in ("completed", "failed", "canceled")

    @property
    def replans(self) -> int:
        """Times that a strategy was asked again."""
        return max(self.plannings - 1, 0)

    @property
    def targets_left(self) -> int:
        """Targets nobody has visited."""
        return sum(target.is_open for target in self.targets.values())

    @property
    def is_accomplished(self) -> bool:
        """Whether there were targets and none is left to visit.

        An exploration ends when the map shows no frontier any more, see `Replanning`.
        """
        return (
            self.request.exploration is None
            and self.targets_left == 0
            and any(target.visited_by is not None for target in self.targets.values())
        )

    def is_new(self, sequence: int) -> bool:
        """Whether a report with this number has not been accepted before."""
        return sequence > self.sequence or sequence in self.missing

    def decide(self, time_s: float, kind: str, reason: str) -> None:
        """Notes a decision with its reason."""
        self.decisions.append(
            Decision(time_s=time_s, revision=self.revision, kind=kind, reason=reason)
        )
        del self.decisions[:-DECISIONS_KEPT]

    def remark(self, remarks: Mapping[str, str]) -> None:
        """Notes which instructions are not obeyed, and why; all others are."""
        for identifier, given in self.instructions.items():
            given.remark = remarks.get(identifier, "")

    def disturb(self) -> None:
        """Something has happened that the plan in force does not reckon with."""
        self.plan_disturbed, self.disturbed_by = True, self.events
        self.hopeless_since_s = None

    def recover(self) -> None:
        """The team can do something."""
        self.hopeless_since_s = None
        if self.status in ("queued", "delayed"):
            self.status, self.status_reason = "underway", ""

    def count_failure(self, robot_id: str, command: Command) -> None:
        """A robot did not carry out a command to a place."""
        pair = (robot_id, command.location or "")
        before = self.failures.get(pair, Failures(0, 0))
        self.failures[pair] = Failures(before.count + 1, self.news)

    def note_news(self) -> None:
        """Something has come to be known, or been done, that changes what robots can do."""
        self.news += 1
        self.restless = 0

    def close_command(self, robot_id: str, command_id: str) -> None:
        """A command was reported as finished or failed."""
        self.closed.add(command_id)
        del self.orders[command_id]
        if (current := self.commands.get(robot_id)) is not None and current.id == command_id:
            self.drop_command(robot_id)

    def drop_command(self, robot_id: str) -> None:
        """A robot has no command any more; should it report it as finished, that is a fact."""
        if (command := self.commands.pop(robot_id, None)) is not None:
            self.issued_at_s.pop(command.id, None)
