"""What a report of the fleet does to a mission."""

from service.coordination.fleet_robot import apart, has_left
from service.coordination.mission import Mission, MissionBlockade
from service.messages.report import (
    Command,
    CommandKind,
    FailedCommand,
    FinishedCommand,
    Report,
    RobotActivity,
    RobotReport,
)

_BUSY: frozenset[RobotActivity] = frozenset({"clearing", "docking", "undocking"})
_LOCATED: frozenset[CommandKind] = frozenset({"move", "explore", "dock", "undock"})


def apply_report(mission: Mission, report: Report) -> None:
    """The mission after a report; one that was overtaken contributes its facts alone."""
    late = report.sequence < mission.sequence
    if late:
        mission.missing.discard(report.sequence)
    else:
        mission.missing |= set(range(mission.sequence + 1, report.sequence))
        mission.sequence = report.sequence
        mission.time_s = max(mission.time_s, report.time_s)
        for robot_report in report.robots:
            _apply_robot(mission, robot_report)
    if mission.status == "queued":
        mission.status, mission.status_reason = "underway", ""
    for blockade in report.blockades:
        # Seen again: the same thing, or one that is known to be cleared.
        if blockade.id not in mission.blockades:
            mission.blockades[blockade.id] = MissionBlockade(
                blockade.id,
                blockade.segment_m,
                blockade.clear_duration_s,
                seen_at_s=report.time_s,
            )
            mission.hopeless_since_s = None
            mission.note_news()
    if report.map_patches:
        _apply_patches(mission, report)
    for finished in report.finished:
        _finish(mission, finished, report.time_s)
    for failed in report.failed:
        _fail(mission, failed, report.time_s)


def _apply_patches(mission: Mission, report: Report) -> None:
    change = mission.map.change(report.sequence, report.map_patches)
    mission.map.apply(report.sequence, report.map_patches)
    if change.cells == 0:
        return
    mission.hopeless_since_s = None
    mission.note_news()
    mission.decide(mission.time_s, "map changed", f"in {change.cells} cells")
    types = mission.request.robot_types
    carries = any(kind.capacity > 0 for kind in types.values())
    if carries and mission.request.exploration is None:
        # Where carriers and rovers meet may have moved: the plan in force names the old places.
        # In an exploration every patch would do so; there the plan goes on as far as it can.
        mission.disturb()
    for command in mission.commands.values():
        radius_m = types[mission.robots[command.robot].type].radius_m
        if mission.map.bars(command.path_m, radius_m, change):
            mission.barred.add(command.id)


def _apply_robot(mission: Mission, report: RobotReport) -> None:
    robot = mission.robots[report.id]
    robot.pose = report.pose
    fails = report.state == "failed" != robot.state
    robot.state = report.state
    robot.command = report.command
    robot.busy_until_s = report.busy_until_s
    if report.command in mission.ahead and report.command in mission.orders:
        # It has gone on by itself while nobody could tell it anything.
        mission.commands[robot.id] = mission.orders[report.command]
    robot.reported_at_s = mission.time_s
    if apart(robot.pose, robot.still_pose) or robot.state in _BUSY:
        robot.still_pose, robot.still_since_s = robot.pose, mission.time_s
        mission.hopeless_since_s = None
    if robot.lost:
        robot.lost = False
        mission.disturb()
        mission.decide(mission.time_s, "robot back", f"{robot.id} reports again")
    if fails:
        mission.drop_command(robot.id)
        mission.disturb()
    if robot.state != "docked" and has_left(robot):
        robot.arrived_at = None


def _finish(mission: Mission, finished: FinishedCommand, heard_at_s: float) -> None:
    if finished.command in mission.closed:
        return
    robot_id, command = finished.robot, mission.orders[finished.command]
    robot = mission.robots[robot_id]
    time_s = heard_at_s if finished.time_s is None else min(finished.time_s, heard_at_s)
    # A robot that could not tell at once has moved on since.
    place_m = finished.position_m or robot.position_m
    mission.close_command(robot_id, command.id)
    mission.done.append(command)
    mission.hopeless_since_s = None
    if command.kind not in ("move", "wait"):
        mission.note_news()
    match command.kind:
        case "explore":
            target = mission.targets.get(command.location or "")
            if target is not None and target.visited_by is None:
                target.visited_by, target.visited_at_s = robot_id, time_s
                target.visited_from_m = place_m
        case "clear":
            blockade = mission.blockades.get(command.location or "")
            if blockade is not None and blockade.cleared_by is None:
                blockade.cleared_by, blockade.cleared_at_s = robot_id, time_s
        case "dock":
            _board(mission, robot_id, command, aboard=True)
        case "undock":
            _board(mission, robot_id, command, aboard=False)
        case "move" | "wait":
            pass
    if apart((*place_m, 0.0), robot.pose):
        robot.arrived_at = None
    elif command.kind in _LOCATED:
        robot.arrived_at, robot.arrival_pose = command.location, robot.pose


def _board(mission: Mission, robot_id: str, command: Command, *, aboard: bool) -> None:
    """Either of the two robots may report the docking; the rover is the one that is carried."""
    partner_id = command.partner or ""
    carrier_types = {
        name for name, kind in mission.request.robot_types.items() if kind.capacity > 0
    }
    rover_id, carrier_id = robot_id, partner_id
    if mission.robots[robot_id].type in carrier_types:
        rover_id, carrier_id = partner_id, robot_id
    rover = mission.robots[rover_id]
    rover.carrier = carrier_id if aboard else None
    if aboard and rover.state != "failed":
        rover.state = "docked"
    elif rover.state in ("docked", "undocking"):
        rover.state = "idle"
        rover.arrived_at, rover.arrival_pose = command.location, rover.pose


def _fail(mission: Mission, failed: FailedCommand, time_s: float) -> None:
    if failed.command in mission.closed:
        return
    robot_id, command = failed.robot, mission.orders[failed.command]
    mission.close_command(robot_id, command.id)
    mission.disturb()
    mission.count_failure(robot_id, command)
    mission.decide(
        time_s,
        "command failed",
        f"{robot_id} gave up {command.kind} {command.location or ''}: {failed.reason}",
    )
