"""Exploration with marsupial teams as a planning problem (Wurm, section 3.4.2)."""

from collections import Counter
from collections.abc import Iterable, Sequence
from math import isfinite
from pathlib import Path

from domains.formulation import (
    Formulation,
    Order,
    OrderKind,
    PathCost,
    asked,
    place_of,
    reachable,
)
from domains.geometry_text import write_location, write_robot
from domains.mission_state import Activity, MeetingPoint, MissionState, RobotState
from domains.naming import Names
from domains.pddl_text import ProblemText
from planner import Step
from semantic_attachments.world import RobotModel, World

SOONEST_S = 0.1
"""A timed literal lies after time 0, also for an activity that should have ended by now."""


class MarsupialFormulation(Formulation):
    """Robots that have arrived at a meeting point are at it; all others are at places of their own.

    A dock or undock under way ends by timed literals: until then neither robot is anywhere.
    """

    def write(
        self, text: ProblemText, world: World, state: MissionState, goals: Iterable[str]
    ) -> None:
        names = self.names(state)
        for target in state.targets:
            write_location(text, target.id, "target", target.position_m)
        for meeting in state.meeting_points:
            write_location(text, meeting.id, "meeting", meeting.position_m)
        team = [robot for robot in state.robots if robot.activity is not Activity.FAILED]
        aboard = Counter(
            robot.partner
            for robot in team
            if robot.type == "rover" and robot.activity in (Activity.DOCKED, Activity.DOCKING)
        )
        for robot in team:
            model = world.robots[names.name(robot.id)]
            write_robot(text, robot.id, robot.type, model)
            if robot.type == "carrier":
                text.fluent("num_docked", robot.id, value=aboard[robot.id])
                text.fluent("capacity", robot.id, value=state.capacities.get(robot.id, 0))
            for own in _own(world, model, state):
                text.fact("can_explore", robot.id, own)
            self._write_position(text, robot, state)
        for goal in goals:
            text.goal("explored", goal)

    def _write_position(self, text: ProblemText, robot: RobotState, state: MissionState) -> None:
        if robot.activity is Activity.DOCKED and robot.partner is not None:
            text.fact("on", robot.id, robot.partner)
            return
        place = robot.arrived_at
        if place not in {meeting.id for meeting in state.meeting_points} or place is None:
            place = place_of(robot.id)
            write_location(text, place, "location", robot.position_m)
        free_in_s = max(robot.free_at_s - state.time_s, SOONEST_S)
        if robot.activity is Activity.DOCKING and robot.type == "rover" and robot.partner:
            text.timed_fact(free_in_s, "on", robot.id, robot.partner)
        elif robot.activity in (Activity.DOCKING, Activity.UNDOCKING):
            text.timed_fact(free_in_s, "at", robot.id, place)
        else:
            text.fact("at", robot.id, place)

    def orders(self, step: Step, names: Names) -> Sequence[Order]:
        arguments = [names.id(name) for name in step.arguments]
        match step.action:
            case "move":
                return [Order(arguments[0], OrderKind.MOVE, arguments[2])]
            case "explore":
                return [Order(arguments[0], OrderKind.EXPLORE, arguments[2])]
            case "dock" | "undock":
                kind = OrderKind(step.action)
                rover, carrier, meeting = arguments
                return [Order(rover, kind, meeting, carrier), Order(carrier, kind, meeting, rover)]
            case _:
                raise ValueError(f"the marsupial domain has no action {step.action!r}")

    def departing(
        self, action: str, ids: tuple[str, ...], robot: RobotState, state: MissionState
    ) -> Sequence[tuple[str, tuple[str, ...]]]:
        if action not in ("move", "explore"):
            return [(action, ids)]
        return [(action, (robot.id, self.standing(robot, state), *ids[2:]))]

    def standing(self, robot: RobotState, state: MissionState) -> str:
        meetings = {meeting.id for meeting in state.meeting_points}
        arrived = robot.arrived_at
        return arrived if arrived is not None and arrived in meetings else place_of(robot.id)

    def visit(self, robot: str, start: str, target: str) -> tuple[str, tuple[str, ...]]:
        return "explore", (robot, start, target)

    def worthwhile(self, cost: PathCost, state: MissionState) -> tuple[MeetingPoint, ...]:
        """Those from which rovers can get to a target, or get away from where they are."""
        names = self.names(state)
        rovers = [
            robot
            for robot in state.robots
            if robot.type == "rover" and robot.activity is not Activity.FAILED
        ]
        if not rovers:
            return ()
        meetings = [names.name(meeting.id) for meeting in state.meeting_points]
        calls: dict[tuple[str, str, str], str] = {}
        for target in state.targets:
            for meeting in meetings:
                calls[names.name(rovers[0].id), meeting, names.name(target.id)] = meeting
        for rover in rovers:
            if rover.activity is not Activity.DOCKED:
                for meeting in meetings:
                    calls[names.name(rover.id), names.name(place_of(rover.id)), meeting] = meeting
        times_s = asked(cost, list(calls))
        wanted = {calls[call] for call, time_s in times_s.items() if isfinite(time_s)}
        busy = {name for robot in state.robots for name in self._meeting(robot, names)}
        return tuple(
            meeting for meeting in state.meeting_points if names.name(meeting.id) in wanted | busy
        )

    def attainable(self, world: World, cost: PathCost, state: MissionState) -> frozenset[str]:
        names = self.names(state)
        goals = {names.name(target.id) for target in state.targets}
        meetings = [names.name(meeting.id) for meeting in state.meeting_points]
        team = [robot for robot in state.robots if robot.activity is not Activity.FAILED]
        reached: dict[str, set[str]] = {
            robot.id: set()
            if robot.activity is Activity.DOCKED
            else {names.name(place_of(robot.id)), *self._meeting(robot, names)}
            for robot in team
        }
        # A path ends near a place, which for a carrier may be on ground that only rovers enter.
        own = {
            robot.id: [
                names.name(target)
                for target in _own(world, world.robots[names.name(robot.id)], state)
            ]
            for robot in team
        }
        # Places that a robot has looked out from: what it could not reach stays out of its reach.
        departed: dict[str, set[str]] = {robot.id: set() for robot in team}
        changed = True
        while changed:
            changed = False
            for robot in team:
                been = reached[robot.id]
                left = [goal for goal in (*own[robot.id], *meetings) if goal not in been]
                starts = been - departed[robot.id]
                departed[robot.id] |= starts
                arrivals = reachable(cost, names.name(robot.id), sorted(starts), left)
                if robot.type == "rover":
                    arrivals |= self._carried(robot, team, reached, set(meetings)) - been
                changed |= bool(arrivals)
                been |= arrivals
        visited = set().union(*(reached[robot.id] for robot in team), set()) & goals
        return frozenset(names.id(name) for name in visited)

    @staticmethod
    def _meeting(robot: RobotState, names: Names) -> list[str]:
        arrived = robot.arrived_at
        return [names.name(arrived)] if arrived is not None and arrived in names else []

    @staticmethod
    def _carried(
        rover: RobotState,
        team: Sequence[RobotState],
        reached: dict[str, set[str]],
        meetings: set[str],
    ) -> set[str]:
        """Meeting points where some carrier could put the rover down."""
        carried: set[str] = set()
        for carrier in team:
            if carrier.type != "carrier":
                continue
            aboard = rover.activity is Activity.DOCKED and rover.partner == carrier.id
            if aboard or reached[rover.id] & reached[carrier.id] & meetings:
                carried |= reached[carrier.id] & meetings
        return carried


FORMULATION = MarsupialFormulation(
    Path(__file__).parent, ["pathCost", "exploreCost", "dockCost", "undockCost"]
)


def _own(world: World, model: RobotModel, state: MissionState) -> list[str]:
    """The targets on ground that a robot enters."""
    return [
        target.id
        for target in state.targets
        if world.grid.terrain_class_at(target.position_m) in model.enters
    ]
