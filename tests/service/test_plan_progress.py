"""What is left of a plan: done steps, late steps, robots that are early."""

from dataclasses import replace

from domains import catalogue
from domains.formulation import OrderKind
from domains.mission_state import BlockadeState, MissionState, RobotState, Target
from service.coordination.plan_progress import from_here, remainder
from service.messages.plan import PlanStep
from service.messages.report import Command

DISASTER = catalogue.load("disaster")
PLAN = [
    PlanStep(start_s=0.0, action="move", arguments=["c", "c place", "b"], duration_s=10.0),
    PlanStep(start_s=10.0, action="clear", arguments=["c", "b"], duration_s=20.0),
    PlanStep(start_s=0.0, action="move", arguments=["e", "e place", "b"], duration_s=5.0),
    PlanStep(
        start_s=30.0, action="explore-from-blockade", arguments=["e", "b", "t"], duration_s=4.0
    ),
]


def state(time_s: float, **arrived: str) -> MissionState:
    return MissionState(
        time_s=time_s,
        robots=(
            RobotState("c", "clearer", (0.0, 0.0), arrived_at=arrived.get("c")),
            RobotState("e", "explorer", (1.0, 0.0), arrived_at=arrived.get("e")),
        ),
        targets=(Target("t", (9.0, 0.0)),),
        blockades=(BlockadeState("b", ((5.0, -1.0), (5.0, 1.0)), 20.0),),
    )


def done(robot: str, kind: str, location: str) -> Command:
    return Command.model_validate(
        {"id": "r1", "robot": robot, "kind": kind, "location": location, "revision": 1}
    )


def kinds(time_s: float, *commands: Command, **arrived: str) -> dict[str, OrderKind]:
    now = state(time_s, **arrived)
    left = remainder(DISASTER, now, PLAN, commands)
    return {order.robot: order.kind for order in left.assignments(DISASTER, now)}


def test_at_the_beginning_both_drive() -> None:
    assert kinds(0.0) == {"c": OrderKind.MOVE, "e": OrderKind.MOVE}


def test_a_robot_that_is_early_begins_what_waits_for_nobody() -> None:
    assert kinds(7.0, done("c", "move", "b"), c="b") == {
        "c": OrderKind.CLEAR,
        "e": OrderKind.MOVE,
    }


def test_a_robot_that_waits_for_another_goes_on_waiting() -> None:
    moved = (done("e", "move", "b"), done("c", "move", "b"))
    assert kinds(12.0, *moved, c="b", e="b")["e"] is OrderKind.WAIT


def test_when_it_is_time_it_goes_however_late_its_movement_was() -> None:
    moved = (done("e", "move", "b"), done("c", "move", "b"), done("c", "clear", "b"))
    assert kinds(45.0, *moved, c="b", e="b")["e"] is OrderKind.EXPLORE


def test_what_is_done_is_not_left() -> None:
    left = remainder(DISASTER, state(31.0), PLAN, [done("c", "clear", "b")])
    assert [step.action for step in left.plan] == ["move", "explore-from-blockade"]
    assert left.ends_s() == {("e", "t"): 3.0}


def test_a_movement_to_a_blockade_that_is_cleared_is_left_out() -> None:
    cleared = replace(state(31.0), blockades=())
    left = remainder(DISASTER, cleared, PLAN, [done("c", "clear", "b")])
    assert [step.action for step in left.plan] == ["explore-from-blockade"]


def started_from_here(time_s: float, *commands: Command) -> list[str]:
    now = state(time_s)
    left = remainder(DISASTER, now, PLAN, commands)
    return [" ".join((step.action, *step.arguments)) for step in from_here(left, DISASTER, now)]


def test_planning_anew_starts_with_the_plan_in_force_from_where_the_robots_are() -> None:
    names = DISASTER.names(state(7.0))
    c_place, e_place = names.name("c place"), names.name("e place")
    assert started_from_here(7.0) == [
        f"move c {c_place} b",
        f"move e {e_place} b",
        "clear c b",
        "explore-from-blockade e b t",
    ]
    # Both stand at the blockade, but the planner knows them at places of their own.
    there = started_from_here(11.0, done("c", "move", "b"), done("e", "move", "b"))
    assert there == [
        f"move c {c_place} b",
        "clear c b",
        f"move e {e_place} b",
        "explore-from-blockade e b t",
    ]
