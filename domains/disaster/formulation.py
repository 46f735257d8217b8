"""Disaster recovery as a planning problem (Wurm, section 3.5.2)."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from domains.formulation import Formulation, Order, OrderKind, PathCost, place_of, reachable
from domains.geometry_text import write_location, write_robot
from domains.mission_state import Activity, MissionState, RobotState
from domains.naming import Names
from domains.pddl_text import ProblemText
from planner import Step
from semantic_attachments.world import World

SOONEST_S = 0.1
"""A timed literal lies after time 0, also for an activity that should have ended by now."""


class DisasterFormulation(Formulation):
    """Robots start from places of their own; a clearer at work comes free by a timed literal."""

    def write(
        self, text: ProblemText, world: World, state: MissionState, goals: Iterable[str]
    ) -> None:
        names = self.names(state)
        for target in state.targets:
            write_location(text, target.id, "mission_target", target.position_m)
        for blockade in state.blockades:
            (x_from, y_from), (x_to, y_to) = blockade.segment_m
            write_location(text, blockade.id, "blockade", blockade.centre_m)
            text.fluent("x-from", blockade.id, value=x_from)
            text.fluent("y-from", blockade.id, value=y_from)
            text.fluent("x-to", blockade.id, value=x_to)
            text.fluent("y-to", blockade.id, value=y_to)
            text.fluent("clear-duration", blockade.id, value=blockade.clear_duration_s)
        known = {blockade.id for blockade in state.blockades}
        for robot in state.robots:
            if robot.activity is Activity.FAILED:
                continue
            write_robot(text, robot.id, robot.type, world.robots[names.name(robot.id)])
            if robot.activity is Activity.CLEARING and robot.partner in known:
                free_in_s = max(robot.free_at_s - state.time_s, SOONEST_S)
                text.timed_fact(free_in_s, "at", robot.id, robot.partner)
                text.timed_fact(free_in_s, "cleared", robot.partner)
            else:
                write_location(text, place_of(robot.id), "free_location", robot.position_m)
                text.fact("at", robot.id, place_of(robot.id))
        for goal in goals:
            text.goal("explored", goal)

    def orders(self, step: Step, names: Names) -> Sequence[Order]:
        robot = names.id(step.arguments[0])
        location = names.id(step.arguments[-1])
        match step.action:
            case "clear":
                kind = OrderKind.CLEAR
            case "explore" | "explore-from-blockade":
                kind = OrderKind.EXPLORE
            case "move" | "move-from-blockade":
                kind = OrderKind.MOVE
            case _:
                raise ValueError(f"the disaster domain has no action {step.action!r}")
        return [Order(robot, kind, location)]

    def departing(
        self, action: str, ids: tuple[str, ...], robot: RobotState, state: MissionState
    ) -> Sequence[tuple[str, tuple[str, ...]]]:
        here, begins_at = place_of(robot.id), ids[1]
        if begins_at in {blockade.id for blockade in state.blockades}:
            return [("move", (robot.id, here, begins_at)), (action, ids)]
        if action == "clear":
            return [(action, ids)]
        return [(action.removesuffix("-from-blockade"), (robot.id, here, *ids[2:]))]

    def attainable(
        self,
        world: World,  # noqa: ARG002 - whoever gets to a target here can explore it
        cost: PathCost,
        state: MissionState,
    ) -> frozenset[str]:
        names = self.names(state)
        blockades = {names.name(blockade.id) for blockade in state.blockades}
        goals = {names.name(target.id) for target in state.targets}
        team = [robot for robot in state.robots if robot.activity is not Activity.FAILED]
        reached: dict[str, set[str]] = {}
        cleared: set[str] = set()
        for robot in team:
            if robot.activity is Activity.CLEARING and robot.partner and robot.partner in names:
                blockade = names.name(robot.partner)
                cleared.add(blockade)
                reached[robot.id] = {blockade}
            else:
                reached[robot.id] = {names.name(place_of(robot.id))}
        changed = True
        while changed:
            changed = False
            for robot in team:
                been = reached[robot.id]
                sources = sorted(been - (blockades - cleared))
                left = sorted((goals | blockades) - been)
                if found := reachable(cost, names.name(robot.id), sources, left):
                    been |= found
                    changed = True
                if robot.type == "clearer":
                    cleared |= been & blockades
        visited = set().union(*(reached[r.id] & goals for r in team if r.type == "explorer"), set())
        return frozenset(names.id(name) for name in visited)


FORMULATION = DisasterFormulation(Path(__file__).parent, ["pathCost", "clearCost"])
