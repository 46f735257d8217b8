"""A mission: the state that its events add up to.

`Mission.apply` is the only place that changes it. The same events in the same order give the same
mission, before and after a crash.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import hypot

from service.coordination.events import (
    CommandGivenUp,
    Event,
    InstructionGiven,
    InstructionWithdrawn,
    MissionClosed,
    MissionCreated,
    OrdersIssued,
    PlanKept,
    PlanningFailed,
    ReportAccepted,
    RobotJoined,
    RobotLeft,
    RobotLost,
    TargetAdded,
    TargetRemoved,
)
from service.messages.base import Pose, Position
from service.messages.instruction import (
    Deadline,
    Forbid,
    Instruction,
    Pin,
    Priority,
    TakeOver,
)
from service.messages.mission import CreateMission, RobotMessage
from service.messages.plan import Decision, PlanStep
from service.messages.report import (
    Command,
    CommandKind,
    MissionStatus,
    Report,
    RobotActivity,
    RobotReport,
)

DECISIONS_KEPT = 200
ARRIVAL_TOLERANCE_M = 0.5
"""A robot that has moved further than this has left the place where it arrived."""
_BUSY: frozenset[RobotActivity] = frozenset({"clearing", "docking", "undocking"})
_LOCATED: frozenset[CommandKind] = frozenset({"move", "explore", "dock", "undock"})


@dataclass(slots=True)
class FleetRobot:
    """A robot as last reported."""

    id: str
    type: str
    pose: Pose
    state: RobotActivity = "idle"
    command: str | None = None
    busy_until_s: float | None = None
    carrier: str | None = None
    arrived_at: str | None = None
    """Where its last movement ended, until it moves on."""
    arrival_pose: Pose = (0.0, 0.0, 0.0)
    reported_at_s: float = 0.0
    still_since_s: float = 0.0
    """It has not left `still_pose` since."""
    still_pose: Pose = (0.0, 0.0, 0.0)
    lost: bool = False
    """It has been silent for longer than its lease."""
    left: bool = False
    """It was taken out of the mission."""
    taken_over: bool = False
    """A person drives it."""

    @property
    def takes_part(self) -> bool:
        """Whether it can be planned with."""
        return not (self.lost or self.left or self.taken_over) and self.state != "failed"

    @property
    def position_m(self) -> Position:
        """Where it is in the map frame."""
        return self.pose[0], self.pose[1]


@dataclass(slots=True)
class MissionTarget:
    """A place to visit."""

    id: str
    position_m: Position
    visited_by: str | None = None
    visited_at_s: float | None = None
    removed: bool = False

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


@dataclass(slots=True)
class Mission:
    """The aggregate; built by `Mission.created`, changed by `apply` alone."""

    id: str
    request: CreateMission
    robots: dict[str, FleetRobot]
    targets: dict[str, MissionTarget]
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
    done: list[Command] = field(default_factory=list)
    """Commands carried out since the plan in force was begun to be made, in order."""
    commands: dict[str, Command] = field(default_factory=dict)
    """The command in force of each robot."""
    issued_at_s: dict[str, float] = field(default_factory=dict)
    orders: dict[str, Command] = field(default_factory=dict)
    """Every command ever issued that is not closed: a late `finished` is still a fact."""
    closed: set[str] = field(default_factory=set)
    """Commands reported as finished or failed."""
    failures: dict[tuple[str, str], int] = field(default_factory=dict)
    """How often a robot gave up a command to a place."""
    instructions: dict[str, GivenInstruction] = field(default_factory=dict)
    decisions: list[Decision] = field(default_factory=list)
    events: int = 0

    @classmethod
    def created(cls, event: MissionCreated) -> "Mission":
        """The mission as it begins."""
        request = event.request
        return cls(
            id=event.id,
            request=request,
            robots={robot.id: _fleet_robot(robot, 0.0) for robot in request.robots},
            targets={t.id: MissionTarget(t.id, t.position_m) for t in request.targets},
            events=1,
        )

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
        """Whether there were targets and none is left to visit."""
        return self.targets_left == 0 and any(
            target.visited_by is not None for target in self.targets.values()
        )

    def is_new(self, sequence: int) -> bool:
        """Whether a report with this number has not been accepted before."""
        return sequence > self.sequence or sequence in self.missing

    def apply(self, event: Event) -> None:
        """Brings the mission to the state after `event`."""
        self.events += 1
        match event:
            case ReportAccepted(report=report):
                self._apply_report(report)
            case OrdersIssued():
                self._apply_orders(event)
            case PlanKept():
                self.plannings += 1
                self._decide(event.time_s, "plan kept", event.reason)
                self._recover()
            case PlanningFailed():
                self.plannings += 1
                self._decide(event.time_s, "no plan", event.reason)
                self.status, self.status_reason = "delayed", event.reason
                if not event.hopeless:
                    self.hopeless_since_s = None
                elif self.hopeless_since_s is None:
                    self.hopeless_since_s = event.time_s
            case CommandGivenUp():
                self._give_up(event)
            case RobotLost():
                self.robots[event.robot].lost = True
                self._disturb()
                self._drop_command(event.robot)
                self._decide(event.time_s, "robot lost", f"{event.robot} fell silent")
            case MissionClosed():
                if self.is_over:
                    raise ValueError(f"mission {self.id} has ended before, as {self.status}")
                self.status, self.status_reason = event.status, event.reason
                self.commands.clear()
                self._decide(event.time_s, event.status, event.reason)
            case MissionCreated():
                raise ValueError(f"mission {self.id} was created before")
            case _:
                self._apply_change(event)

    def _apply_change(self, event: Event) -> None:
        """What people change in a mission that is under way."""
        self._disturb()
        match event:
            case RobotJoined(robot=robot):
                self.robots[robot.id] = _fleet_robot(robot, self.time_s)
                self._decide(event.time_s, "robot joined", robot.id)
            case RobotLeft(robot=robot_id):
                self.robots[robot_id].left = True
                self._drop_command(robot_id)
                self._decide(event.time_s, "robot left", robot_id)
            case TargetAdded(target=target):
                self.targets[target.id] = MissionTarget(target.id, target.position_m)
                self._decide(event.time_s, "target added", target.id)
            case TargetRemoved(target=target_id):
                self.targets[target_id].removed = True
                self._decide(event.time_s, "target removed", target_id)
            case InstructionGiven():
                self._instruct(event)
            case InstructionWithdrawn():
                self._withdraw(event)

    def _decide(self, time_s: float, kind: str, reason: str) -> None:
        self.decisions.append(
            Decision(time_s=time_s, revision=self.revision, kind=kind, reason=reason)
        )
        del self.decisions[:-DECISIONS_KEPT]

    def _disturb(self) -> None:
        self.plan_disturbed, self.disturbed_by = True, self.events
        self.hopeless_since_s = None

    def _recover(self) -> None:
        self.hopeless_since_s = None
        if self.status in ("queued", "delayed"):
            self.status, self.status_reason = "underway", ""

    # People

    def _instruct(self, event: InstructionGiven) -> None:
        instruction = event.instruction
        self.instructions[event.id] = GivenInstruction(event.id, instruction, event.time_s)
        if isinstance(instruction, TakeOver):
            self.robots[instruction.robot].taken_over = True
            self._drop_command(instruction.robot)
        self._decide(event.time_s, "instruction", f"{event.id}: {describe(instruction)}")

    def _withdraw(self, event: InstructionWithdrawn) -> None:
        withdrawn = self.instructions.pop(event.id).instruction
        if isinstance(withdrawn, TakeOver):
            self.robots[withdrawn.robot].taken_over = any(
                isinstance(given.instruction, TakeOver)
                and given.instruction.robot == withdrawn.robot
                for given in self.instructions.values()
            )
        self._decide(event.time_s, "instruction withdrawn", f"{event.id}: {describe(withdrawn)}")

    # Reports

    def _apply_report(self, report: Report) -> None:
        late = report.sequence < self.sequence
        if late:
            self.missing.discard(report.sequence)
        else:
            self.missing |= set(range(self.sequence + 1, report.sequence))
            self.sequence = report.sequence
            self.time_s = max(self.time_s, report.time_s)
            for robot_report in report.robots:
                self._apply_robot(robot_report)
        if self.status == "queued":
            self.status, self.status_reason = "underway", ""
        for blockade in report.blockades:
            # Seen again: the same thing, or one that is known to be cleared.
            if blockade.id not in self.blockades:
                self.blockades[blockade.id] = MissionBlockade(
                    blockade.id,
                    blockade.segment_m,
                    blockade.clear_duration_s,
                    seen_at_s=report.time_s,
                )
                self.hopeless_since_s = None
        for finished in report.finished:
            self._finish(finished.robot, finished.command, report.time_s)
        for failed in report.failed:
            self._fail(failed.robot, failed.command, report.time_s, failed.reason)

    def _apply_robot(self, report: RobotReport) -> None:
        robot = self.robots[report.id]
        robot.pose = report.pose
        fails = report.state == "failed" != robot.state
        robot.state = report.state
        robot.command = report.command
        robot.busy_until_s = report.busy_until_s
        robot.reported_at_s = self.time_s
        if _apart(robot.pose, robot.still_pose) or robot.state in _BUSY:
            robot.still_pose, robot.still_since_s = robot.pose, self.time_s
            self.hopeless_since_s = None
        if robot.lost:
            robot.lost = False
            self._disturb()
            self._decide(self.time_s, "robot back", f"{robot.id} reports again")
        if fails:
            self._drop_command(robot.id)
            self._disturb()
        if robot.state != "docked" and _apart(robot.pose, robot.arrival_pose):
            robot.arrived_at = None

    def _finish(self, robot_id: str, command_id: str, time_s: float) -> None:
        if command_id in self.closed:
            return
        command = self.orders[command_id]
        robot = self.robots[robot_id]
        self._close(robot_id, command_id)
        self.done.append(command)
        self.hopeless_since_s = None
        match command.kind:
            case "explore":
                target = self.targets.get(command.location or "")
                if target is not None and target.visited_by is None:
                    target.visited_by, target.visited_at_s = robot_id, time_s
            case "clear":
                blockade = self.blockades.get(command.location or "")
                if blockade is not None and blockade.cleared_by is None:
                    blockade.cleared_by, blockade.cleared_at_s = robot_id, time_s
            case "dock":
                self._board(robot_id, command, aboard=True)
            case "undock":
                self._board(robot_id, command, aboard=False)
            case "move" | "wait":
                pass
        if command.kind in _LOCATED:
            robot.arrived_at, robot.arrival_pose = command.location, robot.pose

    def _board(self, robot_id: str, command: Command, *, aboard: bool) -> None:
        """Either of the two robots may report the docking; the rover is the one that is carried."""
        partner_id = command.partner or ""
        carrier_types = {
            name for name, kind in self.request.robot_types.items() if kind.capacity > 0
        }
        rover_id, carrier_id = robot_id, partner_id
        if self.robots[robot_id].type in carrier_types:
            rover_id, carrier_id = partner_id, robot_id
        rover = self.robots[rover_id]
        rover.carrier = carrier_id if aboard else None
        if aboard and rover.state != "failed":
            rover.state = "docked"
        elif rover.state in ("docked", "undocking"):
            rover.state = "idle"
            rover.arrived_at, rover.arrival_pose = command.location, rover.pose

    def _fail(self, robot_id: str, command_id: str, time_s: float, reason: str) -> None:
        if command_id in self.closed:
            return
        command = self.orders[command_id]
        self._close(robot_id, command_id)
        self._disturb()
        self._count_failure(robot_id, command)
        self._decide(
            time_s,
            "command failed",
            f"{robot_id} gave up {command.kind} {command.location or ''}: {reason}",
        )

    def _give_up(self, event: CommandGivenUp) -> None:
        # The order stays known: should the robot report it as finished after all, that is a fact.
        command = self.orders[event.command]
        self._disturb()
        self._count_failure(event.robot, command)
        self._drop_command(event.robot)
        self.robots[event.robot].still_since_s = event.time_s
        self._decide(
            event.time_s,
            "command failed",
            f"{event.robot} is not carrying out {command.kind} {command.location or ''}: "
            f"{event.reason}",
        )

    def _count_failure(self, robot_id: str, command: Command) -> None:
        place = command.location or ""
        self.failures[robot_id, place] = self.failures.get((robot_id, place), 0) + 1

    def _close(self, robot_id: str, command_id: str) -> None:
        self.closed.add(command_id)
        del self.orders[command_id]
        if (current := self.commands.get(robot_id)) is not None and current.id == command_id:
            self._drop_command(robot_id)

    def _drop_command(self, robot_id: str) -> None:
        if (command := self.commands.pop(robot_id, None)) is not None:
            self.issued_at_s.pop(command.id, None)

    # Orders

    def _apply_orders(self, event: OrdersIssued) -> None:
        self.revision = event.revision
        self._decide(event.time_s, "new plan" if event.new_plan else "next steps", event.reason)
        self.plannings += 1
        if event.new_plan:
            self.plan = PlanInForce(
                tuple(event.steps), event.validated, event.revision, event.time_s
            )
            self.plan_disturbed = event.disturbed
            self.done = list(event.done)
        for command in event.commands:
            if command.id not in self.issued_at_s:
                self.issued_at_s[command.id] = event.time_s
            self.orders[command.id] = command
        for identifier, given in self.instructions.items():
            given.remark = event.remarks.get(identifier, "")
        current = {command.robot: command for command in event.commands}
        for robot_id in [robot for robot in self.commands if robot not in current]:
            self._drop_command(robot_id)
        self.commands = current
        self._recover()


def _fleet_robot(robot: RobotMessage, time_s: float) -> FleetRobot:
    return FleetRobot(
        robot.id,
        robot.type,
        robot.pose,
        state="idle" if robot.carrier is None else "docked",
        carrier=robot.carrier,
        reported_at_s=time_s,
        still_since_s=time_s,
        still_pose=robot.pose,
    )


def _apart(one: Pose, other: Pose) -> bool:
    return hypot(one[0] - other[0], one[1] - other[1]) > ARRIVAL_TOLERANCE_M


def describe(instruction: Instruction) -> str:
    """An instruction in a sentence."""
    match instruction:
        case Pin(robot=robot, location=location):
            return f"only {robot} goes to {location}"
        case Forbid(robot=robot, location=location):
            return f"{robot} does not go to {location}"
        case Priority(target=target, priority=priority):
            return f"{target} has priority {priority}"
        case Deadline(target=target, time_s=time_s):
            return f"visit {target} by {time_s:g} s"
        case TakeOver(robot=robot):
            return f"a person drives {robot}"


def rebuilt(events: Iterable[Event]) -> Mission:
    """The mission that these events add up to.

    Raises:
        ValueError: they do not begin with the mission's creation.
    """
    stream = iter(events)
    first = next(stream, None)
    if not isinstance(first, MissionCreated):
        raise ValueError("a mission's events begin with its creation")
    mission = Mission.created(first)
    for event in stream:
        mission.apply(event)
    return mission
