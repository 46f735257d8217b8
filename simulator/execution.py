"""Carrying out commands: aim, arrive, clear, dock and undock, and saying so once."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace

from simulator.docking import may_dock, meeting_goals, place_beside
from simulator.fleet_client import Command
from simulator.fleet_scenario import FleetScenario, Point, Pose, ScenarioError
from simulator.knowledge import Ending, Knowledge
from simulator.navigation import REACH_M, Navigation
from simulator.robot import Robot
from simulator.slam.pose import between, compose
from simulator.world import World

ARRIVED_M = 0.25
"""a robot this close to a place is there"""
_HALTED_S = 2.0
"""a robot that has wanted to move for so long and could not will not get closer"""
_WAITS_FOR_A_WAY_S = 5.0
"""how long a robot without a way waits for another order, or for the way to be cleared"""
_PATIENCE_S = 30.0
"""how long a robot that cannot move goes on trying before it gives a command up"""


@dataclass(frozen=True, slots=True)
class ExecutedAction:
    """What a robot did, for the Gantt chart."""

    robot: str
    kind: str
    location: str | None
    start_s: float
    end_s: float
    outcome: str
    """finished, failed, replaced or underway (when the simulation ended)"""


class Execution:
    """Turns commands into goals, notices when they are reached, and collects what to report."""

    def __init__(
        self,
        scenario: FleetScenario,
        world: World,
        known: Mapping[str, Knowledge],
        robots: Mapping[str, Robot],
    ) -> None:
        self.scenario = scenario
        self.world = world
        self.known = known
        """by robot; what there is to report goes there"""
        self.robots = robots
        self.actions: list[ExecutedAction] = []
        self.visited: dict[str, float] = {}
        """target -> time of its first visit [s]"""
        self._places: dict[str, Point] = {t.id: t.position_m for t in scenario.targets}

    # --- orders ---

    def assign(self, names: Collection[str], time_s: float) -> None:
        """Has robots obey the newest orders they know of; one with the same command goes on.

        Args:
            names: robots that know the same.
            time_s: now.
        """
        known = next((self.known[name].orders for name in names), {})
        for name, order in known.items():
            robot, command = self.robots[name], order.command
            if name not in names or robot.has_failed or robot.is_busy:
                continue
            same = command is not None and command.id in (robot.order, _id(robot.command))
            if not same:
                robot.order = _id(command)
                self._replace(robot, command, time_s)
            elif command is not None and command.id == _id(robot.command):
                robot.command = command

    def follow_up(self, robot: Robot, time_s: float) -> bool:
        """A robot that is out of contact goes on with what it was told to do next, if anything."""
        if robot.command is None or not robot.command.then:
            return False
        following, *then = robot.command.then
        self._replace(robot, replace(following, then=tuple(then)), time_s)
        return True

    def _replace(self, robot: Robot, command: Command | None, time_s: float) -> None:
        if not robot.command_over:
            self._log(robot, time_s, "replaced")
        robot.command, robot.command_over, robot.began_s = command, command is None, time_s
        robot.stalled_s = 0.0
        robot.activity = "docked" if robot.is_aboard else "idle"
        robot.stop()
        if command is not None and command.kind == "wait":
            robot.command_over = True
        if not robot.command_over:
            self.aim(robot, time_s)

    def aim(self, robot: Robot, time_s: float) -> None:
        """Finds the command's goals and a way to them."""
        command = robot.command
        if command is None or robot.is_aboard:
            return
        robot.goals = self._goals(robot, command)
        if not robot.goals:
            self._give_up(robot, time_s, f"nowhere to stand at {command.location}")
            return
        robot.activity = "driving"
        ends_there = bool(command.path_m) and command.path_m[-1] in robot.goals
        navigation = self._navigation(robot)
        if ends_there and navigation.accepts(robot, command.path_m):
            robot.follow([robot.position, *command.path_m[1:]])
            return
        route = navigation.route(robot, robot.goals)
        if route is None:
            robot.route, robot.timed = [], []
            if robot.waits_since_s is None:
                robot.waits_since_s = time_s
        else:
            robot.follow(route)

    def _navigation(self, robot: Robot) -> Navigation:
        return self.known[robot.id].navigation

    def _goals(self, robot: Robot, command: Command) -> list[Point]:
        navigation = self._navigation(robot)
        partner = self.robots.get(command.partner or "")
        if command.kind in ("dock", "undock") and partner is not None:
            goals = meeting_goals(robot, partner, command, navigation)
            return goals or [robot.position]
        blockade = navigation.known.get(command.location or "")
        if blockade is not None:
            if navigation.reaches(robot, blockade):
                return [robot.position]
            return navigation.approaches(robot, blockade)
        if command.path_m:
            return [command.path_m[-1]]
        if command.location in self._places:
            return [self._places[command.location]]
        return [robot.position]

    # --- progress ---

    def update(self, time_s: float) -> None:
        """Ends what is reached or done, begins what can begin."""
        for robot in self.robots.values():
            if robot.has_failed or time_s < robot.halted_until_s:
                continue
            if robot.is_busy:
                if time_s >= robot.busy_until_s - 1e-9:
                    self._end_busy(robot, time_s)
            elif not robot.command_over and robot.command is not None:
                self._proceed(robot, robot.command, time_s)

    def _proceed(self, robot: Robot, command: Command, time_s: float) -> None:
        navigation = self._navigation(robot)
        blockade = navigation.known.get(command.location or "")
        match command.kind:
            case "clear":
                if blockade is None:
                    if command.location in self.known[robot.id].cleared:
                        self._finish(robot, time_s)
                    else:
                        self._give_up(robot, time_s, f"{command.location} has not been sensed")
                    return
                if navigation.reaches(robot, blockade):
                    self._begin_busy(robot, "clearing", time_s, time_s + blockade.clear_duration_s)
                    return
            case "dock" | "undock":
                if self._meet(robot, command, time_s):
                    return
            case _:
                if robot.is_aboard:
                    self._give_up(robot, time_s, f"it rides on {robot.carrier}")
                    return
                if self._has_arrived(robot, command):
                    if command.kind == "explore" and command.location is not None:
                        self.visited.setdefault(command.location, time_s)
                    self._finish(robot, time_s)
                    return
        self._lose_patience(robot, command, time_s)

    def _lose_patience(self, robot: Robot, command: Command, time_s: float) -> None:
        waits_since_s = robot.waits_since_s
        if waits_since_s is not None and time_s - waits_since_s > _WAITS_FOR_A_WAY_S:
            self._give_up(robot, time_s, f"no way to {command.location} for its body")
        elif robot.stalled_s > _PATIENCE_S:
            self._give_up(robot, time_s, "it cannot get on")

    def _has_arrived(self, robot: Robot, command: Command) -> bool:
        navigation = self._navigation(robot)
        blockade = navigation.known.get(command.location or "")
        if blockade is not None:
            return navigation.reaches(robot, blockade)
        # A meeting point may lie so close to terrain the body must not touch that it cannot stand
        # on it; whoever cannot get closer and reaches it from there has arrived.
        halts = command.kind != "explore" and robot.stalled_s > _HALTED_S
        near_m = robot.kind.radius_m + REACH_M if halts else ARRIVED_M
        return any(math.dist(goal, robot.position) <= near_m for goal in robot.goals)

    def _meet(self, robot: Robot, command: Command, time_s: float) -> bool:
        """Docking and undocking need both robots; True once it is begun, over or given up."""
        partner = self.robots.get(command.partner or "")
        if partner is None or partner.has_failed:
            self._give_up(robot, time_s, f"its partner {command.partner} is not there")
            return True
        carrier, rover = (robot, partner) if robot.kind.capacity else (partner, robot)
        docks = command.kind == "dock"
        if docks == (rover.carrier == carrier.id):
            self._finish(robot, time_s)
            return True
        if docks and rover.is_aboard:
            self._give_up(robot, time_s, f"{rover.id} rides on {rover.carrier}")
            return True
        if docks and not may_dock(carrier, rover, self.robots.values(), self._navigation(robot)):
            return False
        comes = (
            not self._has_arrived(robot, command)
            if carrier is robot
            else carrier.activity == "driving"
        )
        if not docks and (carrier.is_busy or comes):
            return False
        kind, duration_s = (
            ("docking", self.scenario.dock_duration_s)
            if docks
            else ("undocking", self.scenario.undock_duration_s)
        )
        for one in (carrier, rover):
            self._begin_busy(one, kind, time_s, time_s + duration_s)
        return True

    def _begin_busy(self, robot: Robot, activity: str, time_s: float, until_s: float) -> None:
        robot.stop()
        robot.activity, robot.busy_until_s = activity, until_s
        self.known[robot.id].began_work = True
        if activity == "clearing":
            self._log(robot, time_s, "finished", kind="drive")
            robot.began_s = time_s

    def _end_busy(self, robot: Robot, time_s: float) -> None:
        activity, command = robot.activity, robot.command
        robot.activity, robot.busy_until_s = "idle", math.inf
        if activity == "clearing" and command is not None and command.location is not None:
            self.world.clear(command.location)
            self.known[robot.id].see_gone(command.location)
            self.look_again(robot, time_s)
        elif (
            activity in ("docking", "undocking")
            and not robot.kind.capacity
            and not self._change_places(robot, activity)
        ):
            self._give_up(robot, time_s, "there is no room beside the carrier")
            return
        if not robot.command_over:
            self._finish(robot, time_s)

    def _change_places(self, rover: Robot, activity: str) -> bool:
        """Aboard or off board; False if there is no room for the rover."""
        if activity == "docking":
            partner = rover.command.partner if rover.command is not None else None
            carrier = next(
                r
                for r in self.robots.values()
                if r.id == partner
                or (r.command is not None and r.command.partner == rover.id and r.kind.capacity)
            )
            self.world.remove(rover.id)
            rover.carrier, rover.activity = carrier.id, "docked"
            return True
        assert rover.carrier is not None
        place = place_beside(
            rover, self.robots[rover.carrier], self.robots, self._navigation(rover)
        )
        if place is None:
            rover.activity = "docked"
            return False
        try:
            rover.body = _truly(self.robots[rover.carrier], (*place, rover.heading_rad))
            body = rover.body or (*place, rover.heading_rad)
            self.world.place(rover.id, rover.kind.radius_m, body)
        except ScenarioError:
            if rover.body is None:
                raise
            # It is not quite where it believes to be, and there is no room.
            rover.activity = "docked"
            return False
        rover.x, rover.y = place
        rover.carrier = None
        return True

    def look_again(self, robot: Robot, time_s: float) -> None:
        """Has all who know the same as a robot, and wait for a way, look whether there is one."""
        for other in self.robots.values():
            same = self.known[other.id] is self.known[robot.id]
            if same and other.waits_since_s is not None:
                self.aim(other, time_s)

    def reconsider(self, robots: Iterable[Robot], time_s: float) -> None:
        """Finds other ways for robots whose routes a newly sensed blockade cuts."""
        for robot in robots:
            if robot.activity != "driving" or robot.command_over or len(robot.route) < 2:
                continue
            ahead = [robot.position, *robot.route[robot.leg + 1 :]]
            if self._navigation(robot).is_blocked(ahead, robot.kind.radius_m):
                self.aim(robot, time_s)

    # --- endings ---

    def kill(self, robot: Robot, time_s: float) -> None:
        """The robot dies where it stands; it stays there as an obstacle."""
        if not robot.command_over:
            self._log(robot, time_s, "failed")
        robot.stop()
        robot.activity, robot.command_over, robot.busy_until_s = "failed", True, math.inf
        disc = None if robot.is_aboard else (robot.x, robot.y, robot.kind.radius_m)
        self.known[robot.id].see_dead(robot.id, disc)

    def close(self, time_s: float) -> None:
        """Writes down what is underway as the simulation ends."""
        for robot in self.robots.values():
            if not robot.command_over:
                self._log(robot, time_s, "underway")

    def _finish(self, robot: Robot, time_s: float) -> None:
        self._end(robot, time_s, "finished")
        assert robot.command is not None
        self._note_ending(robot, robot.command, time_s, None)

    def give_up(self, robot: Robot, time_s: float, reason: str) -> None:
        """The robot does not go on with its command."""
        self._end(robot, time_s, "failed")
        assert robot.command is not None
        self._note_ending(robot, robot.command, time_s, reason)

    def _note_ending(
        self, robot: Robot, command: Command, time_s: float, reason: str | None
    ) -> None:
        self.known[robot.id].endings.append(
            Ending(robot.id, command.id, time_s, robot.position, reason)
        )

    def _give_up(self, robot: Robot, time_s: float, reason: str) -> None:
        self.give_up(robot, time_s, f"path blocked: {reason}")

    def _end(self, robot: Robot, time_s: float, outcome: str) -> None:
        self._log(robot, time_s, outcome)
        robot.command_over = True
        robot.activity = "docked" if robot.is_aboard else "idle"
        robot.stop()

    def _log(self, robot: Robot, time_s: float, outcome: str, kind: str | None = None) -> None:
        if robot.command is not None and time_s > robot.began_s:
            self.actions.append(
                ExecutedAction(
                    robot.id,
                    kind or robot.command.kind,
                    robot.command.location,
                    robot.began_s,
                    time_s,
                    outcome,
                )
            )


def _truly(carrier: Robot, pose: Pose) -> Pose | None:
    """Where a pose beside a carrier truly is; None if the carrier knows exactly where it is."""
    if carrier.body is None:
        return None
    x, y, heading_rad = compose(carrier.body, between(carrier.pose, pose)).tolist()
    return (x, y, heading_rad)


def _id(command: Command | None) -> str | None:
    return None if command is None else command.id
