"""What must be true of a mission and of a report beyond the shape of their JSON."""

import re
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from domains import catalogue
from semantic_attachments.world import GridMap
from service.coordination.known_map import (
    OCCUPIED_FROM,
    MapError,
    cell_of,
    read_cells,
    read_terrain,
)
from service.coordination.mission import Mission
from service.coordination.mission_map import read_patch
from service.coordination.ports import Fault
from service.coordination.strategies import serves
from service.coordination.strategy import Strategy
from service.messages.base import Position
from service.messages.instruction import Instruction
from service.messages.map_grid import MapMessage
from service.messages.mission import CreateMission, RobotMessage, TargetMessage
from service.messages.report import Report

_ROBOTS = re.compile(r"^\s*([\w -]+?)\s+-\s+robot\s*\)?\s*$", re.MULTILINE)
"""The subtypes of `robot` in a domain's types section, one parent a line."""

SEQUENCE_GAP = 10_000
"""More lost reports than this at once are a client that counts wrong."""


def _duplicates(where: str, ids: Iterable[str], seen: dict[str, str]) -> Iterable[Fault]:
    for index, identifier in enumerate(ids):
        here = f"/{where}/{index}"
        if identifier in seen:
            yield f"{here}/id", f"{identifier!r} is the id of {seen[identifier]} already"
        seen.setdefault(identifier, here)


def _misplaced(cells: NDArray[np.int8], message: MapMessage, position_m: Position) -> str | None:
    """Why nothing can be at a position, or None."""
    where = f"({position_m[0]:g}, {position_m[1]:g})"
    cell = cell_of(message, position_m)
    if cell is None:
        x, y = message.origin_m
        return (
            f"{where} lies outside the map, which spans {x:g} to "
            f"{x + message.width * message.resolution_m:g} m in x and {y:g} to "
            f"{y + message.height * message.resolution_m:g} m in y"
        )
    if cells[cell] >= OCCUPIED_FROM:
        return f"{where} lies in a wall of the map"
    return None


def mission_faults(
    request: CreateMission, strategies: Mapping[str, Strategy], max_cells: int
) -> list[Fault]:
    """Everything that keeps a mission from being accepted; empty if nothing does."""
    faults: list[Fault] = []
    try:
        catalogue.load(request.domain)
    except catalogue.UnknownDomainError as error:
        faults.append(("/domain", str(error)))
    fitting = sorted(
        name for name, strategy in strategies.items() if serves(strategy, request.domain)
    )
    if request.strategy not in strategies:
        faults.append(
            ("/strategy", f"no strategy {request.strategy!r}: there are {', '.join(fitting)}")
        )
    elif request.strategy not in fitting:
        faults.append(
            (
                "/strategy",
                f"strategy {request.strategy!r} is not made for the domain {request.domain!r}: "
                f"use {', '.join(fitting)}",
            )
        )
    faults += _map_faults(request, max_cells)
    faults += _type_faults(request)
    faults += _robot_faults(request)
    return faults


def _map_faults(request: CreateMission, max_cells: int) -> Iterable[Fault]:
    try:
        cells = read_cells(request.map, max_cells)
        read_terrain(request.map)
    except MapError as error:
        yield f"/map/{error.field}", str(error)
        return
    for index, robot in enumerate(request.robots):
        if fault := _misplaced(cells, request.map, (robot.pose[0], robot.pose[1])):
            yield f"/robots/{index}/pose", fault
    for index, target in enumerate(request.targets):
        if fault := _misplaced(cells, request.map, target.position_m):
            yield f"/targets/{index}/position_m", fault


def _type_faults(request: CreateMission) -> Iterable[Fault]:
    known = _roles(request.domain)
    for name, robot_type in request.robot_types.items():
        if known and name not in known:
            there_are = ", ".join(sorted(known))
            yield (
                f"/robot_types/{name}",
                f"the domain {request.domain} has no robot type {name!r}: there are {there_are}",
            )
        for index, terrain in enumerate(robot_type.enters):
            if terrain not in request.map.terrain_classes:
                yield (
                    f"/robot_types/{name}/enters/{index}",
                    f"the map has no terrain class {terrain!r}",
                )


def _roles(domain: str) -> frozenset[str]:
    """Robot types of a domain; empty if the domain is unknown."""
    try:
        text = catalogue.load(domain).domain_path.read_text(encoding="utf-8")
    except catalogue.UnknownDomainError:
        return frozenset()
    return frozenset(name for names in _ROBOTS.findall(text) for name in names.split())


def _robot_faults(request: CreateMission) -> Iterable[Fault]:
    seen: dict[str, str] = {}
    yield from _duplicates("robots", (robot.id for robot in request.robots), seen)
    yield from _duplicates("targets", (target.id for target in request.targets), seen)
    robots = {robot.id: robot for robot in request.robots}
    aboard: dict[str, int] = {}
    for index, robot in enumerate(request.robots):
        if robot.type not in request.robot_types:
            there_are = ", ".join(sorted(request.robot_types))
            yield (
                f"/robots/{index}/type",
                f"{robot.type!r} is not in robot_types: there are {there_are}",
            )
        if robot.carrier is None:
            continue
        here = f"/robots/{index}/carrier"
        carrier = robots.get(robot.carrier)
        if carrier is None or carrier.id == robot.id:
            yield here, f"no other robot has the id {robot.carrier!r}"
            continue
        carrier_type = request.robot_types.get(carrier.type)
        aboard[carrier.id] = aboard.get(carrier.id, 0) + 1
        if carrier_type is not None and aboard[carrier.id] > carrier_type.capacity:
            yield here, f"{carrier.id} holds {carrier_type.capacity} robots and is full"


def report_faults(mission: Mission, report: Report) -> list[Fault]:
    """Everything that keeps a report from being accepted; empty if nothing does."""
    faults: list[Fault] = []
    if report.sequence > mission.sequence + SEQUENCE_GAP:
        faults.append(
            ("/sequence", f"jumps from {mission.sequence} by more than {SEQUENCE_GAP} reports")
        )
    seen: set[str] = set()
    for index, robot in enumerate(report.robots):
        here = f"/robots/{index}"
        if robot.id not in mission.robots:
            faults.append((f"{here}/id", f"the mission has no robot {robot.id!r}"))
        if robot.id in seen:
            faults.append((f"{here}/id", f"{robot.id!r} is reported twice"))
        seen.add(robot.id)
        if cell_of(mission.request.map, (robot.pose[0], robot.pose[1])) is None:
            faults.append((f"{here}/pose", "lies outside the map"))
    for index, blockade in enumerate(report.blockades):
        if blockade.id in mission.robots or blockade.id in mission.targets:
            faults.append(
                (f"/blockades/{index}/id", f"{blockade.id!r} is a robot's or a target's id")
            )
        for end, position_m in enumerate(blockade.segment_m):
            if cell_of(mission.request.map, position_m) is None:
                faults.append((f"/blockades/{index}/segment_m/{end}", "lies outside the map"))
    faults += _patch_faults(mission, report)
    for index, finished in enumerate(report.finished):
        here = f"/finished/{index}"
        faults += _closing_faults(mission, here, finished.robot, finished.command)
    for index, failed in enumerate(report.failed):
        faults += _closing_faults(mission, f"/failed/{index}", failed.robot, failed.command)
    return faults


def _patch_faults(mission: Mission, report: Report) -> Iterable[Fault]:
    for index, patch in enumerate(report.map_patches):
        try:
            read_patch(patch, mission.map.grid)
        except MapError as error:
            yield f"/map_patches/{index}/{error.field}", str(error)


def _closing_faults(mission: Mission, here: str, robot: str, command: str) -> Iterable[Fault]:
    if robot not in mission.robots:
        yield f"{here}/robot", f"the mission has no robot {robot!r}"
    elif command not in mission.closed:
        order = mission.orders.get(command)
        if order is None:
            yield f"{here}/command", f"no command {command!r} was ever given"
        elif order.robot != robot:
            yield f"{here}/command", f"{command!r} was given to {order.robot}"


def robot_faults(mission: Mission, robot: RobotMessage, grid: GridMap) -> list[Fault]:
    """Everything that keeps a robot from joining; empty if nothing does."""
    faults: list[Fault] = []
    known = mission.robots.get(robot.id)
    if known is not None and not known.left:
        faults.append(("/id", f"{robot.id!r} takes part already"))
    elif known is not None and known.type != robot.type:
        faults.append(("/type", f"{robot.id!r} was a {known.type} before it left"))
    if robot.id in mission.targets or robot.id in mission.blockades:
        faults.append(("/id", f"{robot.id!r} is a target's or a blockade's id"))
    if robot.type not in mission.request.robot_types:
        there_are = ", ".join(sorted(mission.request.robot_types))
        faults.append(("/type", f"{robot.type!r} is not in robot_types: there are {there_are}"))
    if fault := _misplaced(grid.cells, mission.request.map, (robot.pose[0], robot.pose[1])):
        faults.append(("/pose", fault))
    if robot.carrier is not None:
        carrier = mission.robots.get(robot.carrier)
        if carrier is None or carrier.left or carrier.id == robot.id:
            faults.append(("/carrier", f"no other robot has the id {robot.carrier!r}"))
        else:
            capacity = mission.request.robot_types[carrier.type].capacity
            aboard = sum(other.carrier == carrier.id for other in mission.robots.values())
            if aboard >= capacity:
                faults.append(("/carrier", f"{carrier.id} holds {capacity} robots and is full"))
    return faults


def target_faults(mission: Mission, target: TargetMessage, grid: GridMap) -> list[Fault]:
    """Everything that keeps a target from being added; empty if nothing does."""
    faults: list[Fault] = []
    if target.id in {**mission.robots, **mission.targets, **mission.blockades}:
        faults.append(("/id", f"{target.id!r} names something else already"))
    if fault := _misplaced(grid.cells, mission.request.map, target.position_m):
        faults.append(("/position_m", fault))
    return faults


def instruction_faults(mission: Mission, instruction: Instruction) -> list[Fault]:
    """Everything that keeps an instruction from being understood; empty if nothing does."""
    faults: list[Fault] = []
    robot = getattr(instruction, "robot", None)
    if robot is not None and (robot not in mission.robots or mission.robots[robot].left):
        faults.append(("/robot", f"the mission has no robot {robot!r}"))
    target = getattr(instruction, "target", None)
    if target is not None and target not in mission.targets:
        faults.append(("/target", f"the mission has no target {target!r}"))
    location = getattr(instruction, "location", None)
    if location is not None and location not in {**mission.targets, **mission.blockades}:
        faults.append(("/location", f"{location!r} is no target and no known blockade"))
    return faults
