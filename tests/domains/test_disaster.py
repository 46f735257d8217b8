"""The passage of figure 3.16: two rooms, one blocked way between them."""

from dataclasses import replace
from math import isfinite

import pytest

import domains
from domains import Activity, MissionState, RobotState, Target
from domains.formulation import Assignment, OrderKind, PathCost
from planner import Plan, Step
from scenarios import examples
from semantic_attachments import GridMap, World, bind

FORMULATION = domains.load("disaster")
GRID = GridMap(examples.passage_cells(), resolution_m=0.1)


def world_of(state: MissionState) -> World:
    return FORMULATION.world(state, GRID, examples.DISASTER_TYPES)


def cost_of(state: MissionState) -> PathCost:
    return bind(["pathCost"], world_of(state))["pathCost"]


def attainable(state: MissionState) -> frozenset[str]:
    return FORMULATION.attainable(world_of(state), cost_of(state), state)


def with_robot(state: MissionState, changed: RobotState) -> MissionState:
    robots = tuple(changed if robot.id == changed.id else robot for robot in state.robots)
    return replace(state, robots=robots)


def plan_of(*steps: tuple[float, str, float]) -> Plan:
    return Plan(
        tuple(
            Step(start, text.split()[0], tuple(text.split()[1:]), duration)
            for start, text, duration in steps
        )
    )


def test_a_blockade_is_a_wall_for_all_but_those_bound_for_it() -> None:
    state = examples.passage()
    cost = cost_of(state)
    assert not isfinite(cost("explorer_1", "explorer_1_place", "target_1"))
    assert 5.0 < cost("explorer_1", "explorer_1_place", "blockade_1") < 6.0
    assert 5.0 < cost("explorer_1", "blockade_1", "target_1") < 7.0


def test_a_clearer_at_work_comes_free_by_timed_literals() -> None:
    state = with_robot(
        replace(examples.passage(), time_s=100.0),
        RobotState(
            "clearer_1", "clearer", (6.4, 3.0), Activity.CLEARING, "blockade_1", free_at_s=112.5
        ),
    )
    text = FORMULATION.problem(world_of(state), state)
    assert "(at 12.500 (at clearer_1 blockade_1))" in text
    assert "(at 12.500 (cleared blockade_1))" in text
    assert "clearer_1_place" not in text


def test_a_failed_robot_takes_no_part() -> None:
    state = examples.passage()
    failed = replace(state.robots[1], activity=Activity.FAILED)
    state = with_robot(state, failed)
    assert "clearer_1" not in FORMULATION.problem(world_of(state), state)
    assert attainable(state) == frozenset()


def test_what_can_be_reached_after_clearing_is_attainable() -> None:
    state = examples.passage()
    assert attainable(state) == {"target_1"}
    walled_in = replace(state, targets=(*state.targets, Target("target_2", (6.5, 0.5))))
    assert attainable(walled_in) == {"target_1"}


def test_ids_of_any_kind_become_names_and_come_back() -> None:
    state = MissionState(
        time_s=0.0,
        robots=(RobotState("Tiny 7", "explorer", (1.5, 3.0)),),
        targets=(Target("Room A", (3.0, 3.0)),),
    )
    assert "(explored room_a)" in FORMULATION.problem(world_of(state), state)
    plan = plan_of((0.0, "explore tiny_7 tiny_7_place room_a", 1.5))
    assert FORMULATION.assignments(plan, state) == (
        Assignment("Tiny 7", OrderKind.EXPLORE, "Room A", expected_duration_s=1.5),
    )


def test_the_first_step_of_each_robot_becomes_its_order() -> None:
    state = examples.passage()
    plan = plan_of(
        (0.0, "move clearer_1 clearer_1_place blockade_1", 6.0),
        (6.0, "clear clearer_1 blockade_1", 20.0),
        (0.0, "move explorer_1 explorer_1_place blockade_1", 5.5),
        (26.001, "explore-from-blockade explorer_1 blockade_1 target_1", 6.0),
    )
    explorer, clearer = FORMULATION.assignments(plan, state)
    assert (explorer.kind, explorer.location) == (OrderKind.MOVE, "blockade_1")
    assert (clearer.kind, clearer.location) == (OrderKind.MOVE, "blockade_1")

    arrived = replace(
        state, robots=tuple(replace(robot, arrived_at="blockade_1") for robot in state.robots)
    )
    explorer, clearer = FORMULATION.assignments(plan, arrived)
    assert explorer.kind is OrderKind.WAIT
    assert (clearer.kind, clearer.location) == (OrderKind.CLEAR, "blockade_1")


def test_a_robot_without_a_step_gets_no_order() -> None:
    state = examples.passage()
    plan = plan_of((0.0, "clear clearer_1 blockade_1", 20.0))
    assert [order.robot for order in FORMULATION.assignments(plan, state)] == ["clearer_1"]


def test_a_plan_of_another_domain_is_refused() -> None:
    with pytest.raises(ValueError, match="no action 'fly'"):
        FORMULATION.assignments(plan_of((0.0, "fly explorer_1", 1.0)), examples.passage())
