"""Which facts ask for a new decision (thesis 3.3: "whenever new information arrives")."""

from collections.abc import Iterator

from service.coordination.mission import Mission
from service.messages.report import Report

MAP_CHANGED = "the map changed"
"""How facts that speak of the map begin."""
LATE_FACTOR = 1.5
LATE_SLACK_S = 5.0
"""A command is late after its expected duration times the factor plus the slack."""


def facts_in(mission: Mission, report: Report) -> list[str]:
    """What `report` tells that `mission`, which has not applied it yet, did not know."""
    return list(dict.fromkeys(_facts(mission, report)))


def _facts(mission: Mission, report: Report) -> Iterator[str]:
    if mission.status == "queued":
        yield "the mission begins"
    for blockade in report.blockades:
        if blockade.id not in mission.blockades:
            yield f"blockade {blockade.id} seen"
    if report.map_patches:
        cells = mission.map.change(report.sequence, report.map_patches).cells
        if cells:
            yield f"{MAP_CHANGED} in {cells} cells"
    for finished in report.finished:
        order = mission.orders.get(finished.command)
        if order is not None and order.kind != "wait":
            where = order.location or order.partner or ""
            yield f"{finished.robot} finished {order.kind} {where}".rstrip()
    for failed in report.failed:
        if failed.command not in mission.closed:
            yield f"{failed.robot} gave up its command: {failed.reason}"
    if report.sequence > mission.sequence:
        yield from _robot_facts(mission, report)


def _robot_facts(mission: Mission, report: Report) -> Iterator[str]:
    for robot_report in report.robots:
        robot = mission.robots[robot_report.id]
        if robot_report.state == "failed" and robot.state != "failed":
            yield f"{robot.id} failed"
        elif robot_report.state != "failed" and (robot.lost or robot.state == "failed"):
            yield f"{robot.id} is back"


def late_robots(mission: Mission) -> list[str]:
    """Robots whose command takes much longer than expected."""
    return [
        robot_id
        for robot_id, command in mission.commands.items()
        if command.kind != "wait"
        and command.expected_duration_s is not None
        and command.id in mission.issued_at_s
        and mission.time_s
        > mission.issued_at_s[command.id] + command.expected_duration_s * LATE_FACTOR + LATE_SLACK_S
    ]


def stuck_robots(mission: Mission, give_up_s: float) -> list[str]:
    """Robots that are late by more than `give_up_s` and have not moved for as long.

    Of one that has not been heard since, nobody knows whether it stands still: its lease decides.
    A robot that clears or docks cannot be interrupted, and one that is to meet another waits for it
    as long as the other moves.
    """
    return [
        robot_id
        for robot_id, command in mission.commands.items()
        if command.kind != "wait"
        and command.expected_duration_s is not None
        and command.id in mission.issued_at_s
        and mission.time_s
        > mission.issued_at_s[command.id] + command.expected_duration_s + give_up_s
        and all(
            mission.robots[one].reported_at_s - mission.robots[one].still_since_s > give_up_s
            for one in (robot_id, command.partner)
            if one in mission.robots
        )
    ]


def is_hopeless(mission: Mission, grace_s: float) -> bool:
    """Whether for `grace_s` the team has been able to do nothing and nothing has happened.

    A person who drives a robot may still change that, and so may a robot that has not been heard
    since and whose lease has not run out.
    """
    since_s = mission.hopeless_since_s
    return (
        since_s is not None
        and mission.time_s - since_s >= grace_s
        and all(
            robot.reported_at_s >= since_s for robot in mission.robots.values() if robot.takes_part
        )
        and not any(robot.taken_over for robot in mission.robots.values())
    )


def silent_robots(mission: Mission) -> list[str]:
    """Robots whose lease has run out while others reported."""
    return [
        robot.id
        for robot in mission.robots.values()
        if not (robot.lost or robot.left)
        and mission.time_s - robot.reported_at_s > mission.request.lease_s
    ]


def is_idle(mission: Mission) -> bool:
    """Whether there is work left and a robot that has no order but to wait."""
    return mission.targets_left > 0 and any(
        robot.takes_part
        and (robot.id not in mission.commands or mission.commands[robot.id].kind == "wait")
        for robot in mission.robots.values()
    )
