"""The annex: a hall for carriers, rooms behind doors that only rovers pass."""

from dataclasses import replace
from math import isfinite

import numpy as np

import domains
import planner
from domains import Activity, MissionState, RobotState
from domains.formulation import OrderKind, PathCost
from planner import Plan, Step
from scenarios import examples
from semantic_attachments import GridMap, RobotModel, World, bind

FORMULATION = domains.load("marsupial")
GRID = GridMap(examples.annex_cells(), resolution_m=0.1)


def world_of(state: MissionState) -> World:
    return FORMULATION.world(state, GRID, examples.MARSUPIAL_TYPES)


def cost_of(state: MissionState) -> PathCost:
    return bind(["pathCost"], world_of(state))["pathCost"]


def attainable(state: MissionState) -> frozenset[str]:
    return FORMULATION.attainable(world_of(state), cost_of(state), state)


def with_robot(state: MissionState, identifier: str, **changes: object) -> MissionState:
    return replace(
        state,
        robots=tuple(
            replace(robot, **changes) if robot.id == identifier else robot  # type: ignore[arg-type]
            for robot in state.robots
        ),
    )


def test_only_rovers_pass_the_doors() -> None:
    cost = cost_of(examples.annex(1, 1, 2))
    assert not isfinite(cost("carrier_1", "door_1", "room_1"))
    assert isfinite(cost("rover_1_1", "door_1", "room_1"))


def test_rooms_are_attainable_as_long_as_there_is_a_rover() -> None:
    state = examples.annex(1, 1, 2)
    assert attainable(state) == {t.id for t in state.targets}
    alone = with_robot(state, "rover_1_1", activity=Activity.FAILED)
    assert attainable(alone) == {"hall_west", "hall_east"}


def test_a_rover_left_in_a_room_can_be_fetched_and_brought_to_another() -> None:
    state = with_robot(
        examples.annex(1, 1, 2),
        "rover_1_1",
        activity=Activity.FREE,
        partner=None,
        position_m=(2.6, 3.4),
    )
    assert "room_2" in attainable(state)


def test_terrain_decides_who_can_explore() -> None:
    state = examples.annex(1, 1, 2)
    terrain = (GRID.cells < 50).astype("uint8")
    terrain[70:130] = 0
    grid = GridMap(GRID.cells, 0.1, terrain=terrain, terrain_classes=("default", "rover_only"))
    types = {
        "carrier": examples.MARSUPIAL_TYPES["carrier"],
        "rover": RobotModel("rover", 0.25, 0.5, enters=("default", "rover_only")),
    }
    text = FORMULATION.problem(FORMULATION.world(state, grid, types), state)
    assert "(can_explore rover_1_1 room_1)" in text
    assert "(can_explore carrier_1 room_1)" not in text
    assert "(can_explore carrier_1 hall_west)" in text


def test_a_target_that_a_carrier_only_gets_near_is_not_its_to_explore() -> None:
    """Paths end near their goals; the plan knows who may stand on which ground."""
    state = examples.annex(1, 1, 2)
    hall = next(target for target in state.targets if target.id == "hall_west")
    column, row = (round(value / 0.1) for value in hall.position_m)
    terrain = np.zeros(GRID.cells.shape, dtype="uint8")
    terrain[row - 3 : row + 4, column - 3 : column + 4] = 1
    grid = GridMap(GRID.cells, 0.1, terrain=terrain, terrain_classes=("default", "rover_only"))
    alone = with_robot(state, "rover_1_1", activity=Activity.FAILED)
    world = FORMULATION.world(alone, grid, examples.MARSUPIAL_TYPES)
    cost = bind(["pathCost"], world)["pathCost"]
    assert isfinite(cost("carrier_1", "carrier_1_place", "hall_west"))
    goals = FORMULATION.attainable(world, cost, alone)
    assert goals == {"hall_east"}
    text = FORMULATION.problem(world, alone, sorted(goals))
    attachments = bind(FORMULATION.attachments, world)
    assert planner.solve(FORMULATION.domain_path, text, attachments=attachments).plan


def test_docking_under_way_ends_by_timed_literals() -> None:
    state = with_robot(
        examples.annex(1, 2, 2),
        "rover_1_1",
        activity=Activity.DOCKING,
        partner="carrier_1",
        free_at_s=8.0,
        arrived_at="door_1",
    )
    state = with_robot(
        state, "carrier_1", activity=Activity.DOCKING, free_at_s=8.0, arrived_at="door_1"
    )
    text = FORMULATION.problem(world_of(state), state)
    assert "(at 8.000 (on rover_1_1 carrier_1))" in text
    assert "(at 8.000 (at carrier_1 door_1))" in text
    assert "(= (num_docked carrier_1) 2)" in text


def test_undocking_orders_both_robots_once_the_carrier_is_there() -> None:
    state = examples.annex(1, 1, 2)
    plan = Plan(
        (
            Step(0.0, "move", ("carrier_1", "carrier_1_place", "door_2"), 2.0),
            Step(2.0, "undock", ("rover_1_1", "carrier_1", "door_2"), 10.0),
        )
    )
    carrier, rover = FORMULATION.assignments(plan, state)
    assert (carrier.kind, carrier.location) == (OrderKind.MOVE, "door_2")
    assert rover.kind is OrderKind.WAIT
    there = with_robot(state, "carrier_1", arrived_at="door_2")
    carrier, rover = FORMULATION.assignments(
        Plan((Step(0.0, "undock", ("rover_1_1", "carrier_1", "door_2"), 10.0),)), there
    )
    assert (carrier.kind, carrier.partner) == (OrderKind.UNDOCK, "rover_1_1")
    assert (rover.kind, rover.partner) == (OrderKind.UNDOCK, "carrier_1")


def test_a_rover_in_the_open_starts_from_a_place_of_its_own() -> None:
    state = replace(examples.annex(1, 1, 2), robots=(RobotState("rover_1_1", "rover", (2.6, 3.4)),))
    text = FORMULATION.problem(world_of(state), state)
    assert "(at rover_1_1 rover_1_1_place)" in text


def test_worthwhile_are_the_doors_of_rooms_with_a_target_or_a_rover() -> None:
    """Rooms without a way between them for rovers."""

    def cost(_robot: str, start: str, goal: str) -> float:
        number = {"rover_1_1_place": "1"}.get(start, start[-1])
        return 1.0 if number == goal[-1] else float("inf")

    state = examples.annex(1, 1, 2)
    doors = [meeting.id for meeting in FORMULATION.worthwhile(cost, state)]
    assert doors == [meeting.id for meeting in state.meeting_points] == ["door_1", "door_2"]
    west = replace(state, targets=tuple(t for t in state.targets if t.id == "room_1"))
    assert [meeting.id for meeting in FORMULATION.worthwhile(cost, west)] == ["door_1"]
    left_behind = with_robot(
        replace(state, targets=()), "rover_1_1", activity=Activity.FREE, partner=None
    )
    assert [meeting.id for meeting in FORMULATION.worthwhile(cost, left_behind)] == ["door_1"]
    nobody = with_robot(state, "rover_1_1", activity=Activity.FAILED)
    assert FORMULATION.worthwhile(cost, nobody) == ()
