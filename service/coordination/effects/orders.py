"""What the service's own decisions do to a mission."""

from service.coordination.events import CommandGivenUp, OrdersIssued, PlanningFailed
from service.coordination.mission import Failures, Mission, PlanInForce
from service.coordination.situation import FAILURES_TOLERATED, avoided, outdated_failures
from service.messages.report import Command

BUSY = ("clearing", "docking", "undocking")


def apply_orders(mission: Mission, event: OrdersIssued) -> None:
    """The commands in force changed, with or without a new plan behind them."""
    mission.revision = event.revision
    mission.decide(event.time_s, "new plan" if event.new_plan else "next steps", event.reason)
    mission.plannings += 1
    if event.new_plan:
        mission.plan = PlanInForce(
            tuple(event.steps), event.validated, event.revision, event.time_s
        )
        mission.plan_disturbed = event.disturbed
        mission.done = list(event.done)
        mission.target_places_m = {
            target.id: target.position_m
            for target in mission.targets.values()
            if target.is_frontier
        }
    for command in event.commands:
        if command.id not in mission.issued_at_s:
            mission.issued_at_s[command.id] = event.time_s
        mission.orders[command.id] = command
        for follow_up in command.then:
            mission.ahead.add(follow_up.id)
            mission.orders[follow_up.id] = Command(
                id=follow_up.id,
                robot=command.robot,
                kind=follow_up.kind,
                location=follow_up.location,
                partner=follow_up.partner,
                revision=command.revision,
            )
    mission.remark(event.remarks)
    current = {command.robot: command for command in event.commands}
    if any(mission.commands.get(robot_id) != command for robot_id, command in current.items()):
        mission.restless += 1
    for robot_id in [robot for robot in mission.commands if robot not in current]:
        mission.drop_command(robot_id)
    mission.commands = current
    mission.barred &= {command.id for command in event.commands}
    mission.recover()


def give_up(mission: Mission, event: CommandGivenUp) -> None:
    """A robot does not get on with its command."""
    # The order stays known: should the robot report it as finished after all, that is a fact.
    command = mission.orders[event.command]
    mission.disturb()
    mission.count_failure(event.robot, command)
    mission.drop_command(event.robot)
    mission.robots[event.robot].still_since_s = event.time_s
    mission.decide(
        event.time_s,
        "command failed",
        f"{event.robot} is not carrying out {command.kind} {command.location or ''}: "
        f"{event.reason}",
    )


def plan_failed(mission: Mission, event: PlanningFailed) -> None:
    """A strategy found nothing: what is in force goes on, but for orders that make no sense now."""
    for robot_id, command in list(mission.commands.items()):
        if mission.robots[robot_id].state not in BUSY and _is_void(mission, command):
            mission.drop_command(robot_id)
    mission.remark(event.remarks)
    mission.plannings += 1
    mission.decide(event.time_s, "no plan", event.reason)
    mission.status, mission.status_reason = "delayed", event.reason
    if not event.hopeless or _allow_again(mission, event.time_s):
        mission.hopeless_since_s = None
    elif mission.hopeless_since_s is None:
        mission.hopeless_since_s = event.time_s


def _allow_again(mission: Mission, time_s: float) -> bool:
    """Whether robots may go where they could not before something happened, for want of others."""
    pairs = outdated_failures(mission)
    for robot_id, place in pairs:
        mission.failures[robot_id, place] = Failures(FAILURES_TOLERATED - 1, mission.news)
        mission.decide(
            time_s,
            "another attempt",
            f"{robot_id} may go to {place} again: it gave up before the map, or what has been "
            "done, was as it is now",
        )
    return bool(pairs)


def _is_void(mission: Mission, command: Command) -> bool:
    """Whether a robot should stop rather than carry out a command, plan or no plan."""
    place = command.location or ""
    if command.id in mission.barred or (command.robot, place) in avoided(mission):
        return True
    target, blockade = mission.targets.get(place), mission.blockades.get(place)
    return (target is not None and not target.is_open) or (
        blockade is not None and blockade.cleared_by is not None
    )
