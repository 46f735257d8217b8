"""What becomes of a decision that was overtaken by reports."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from test_mission_loop import ROOMS, TARGETS, fleet

from domains.formulation import Assignment, OrderKind
from service.coordination.dispatch import Order, commands
from service.coordination.events import (
    CommandGivenUp,
    Event,
    MissionCreated,
    OrdersIssued,
    PlanningFailed,
    ReportAccepted,
)
from service.coordination.history import apply, rebuilt
from service.coordination.mission import Mission
from service.coordination.situation import avoided
from service.messages.mission import CreateMission
from service.messages.report import Command, Report

BLOCKADE = {"id": "b", "segment_m": [[4.0, 3.5], [5.0, 3.5]], "clear_duration_s": 9.0}


def command(identifier: str, kind: str, location: str) -> Command:
    robot = identifier.split("-")[1]
    return Command.model_validate(
        {"id": identifier, "robot": robot, "kind": kind, "location": location, "revision": 1}
    )


MOVE = command("r1-clearer_1", "move", "b")
EXPLORE = command("r1-explorer_1", "explore", "target_1")


def issued(revision: int, *, done: list[Command], disturbed: bool = False) -> OrdersIssued:
    return OrdersIssued(
        time_s=1.0,
        revision=revision,
        reason="",
        commands=[MOVE, EXPLORE] if revision == 1 else [],
        new_plan=True,
        done=done,
        disturbed=disturbed,
    )


def reported(sequence: int, **more: Any) -> ReportAccepted:
    robots = [
        {"id": "explorer_1", "pose": [2.5, 2.5, 0.0], "state": "idle"},
        {"id": "clearer_1", "pose": [4.5, 2.9, 0.0], "state": "idle"},
    ]
    body = {"sequence": sequence, "time_s": float(sequence), "robots": robots, **more}
    return ReportAccepted(report=Report.model_validate_json(json.dumps(body)))


def events() -> Iterator[Event]:
    """The clearer is sent to the blockade, and arrives."""
    request = CreateMission.model_validate_json(json.dumps(fleet().mission(ROOMS, TARGETS)))
    yield MissionCreated(id="m", request=request)
    yield reported(0, blockades=[BLOCKADE])
    yield issued(1, done=[])
    yield reported(1, finished=[{"robot": "clearer_1", "command": MOVE.id}])


@pytest.fixture
def arrived() -> Mission:
    return rebuilt(events())


def orders(*assignments: Assignment) -> dict[str, Order]:
    return {assignment.robot: Order(assignment) for assignment in assignments}


def test_nobody_is_sent_to_where_it_has_just_arrived(arrived: Mission) -> None:
    """The decision was taken on a snapshot in which the clearer was still on its way."""
    stale = orders(
        Assignment("clearer_1", OrderKind.MOVE, "b"),
        Assignment("explorer_1", OrderKind.EXPLORE, "target_1"),
    )
    given = {order.robot: order for order in commands(arrived, stale, revision=2)}
    assert given["clearer_1"].kind == "wait"
    assert given["explorer_1"].id == EXPLORE.id


def test_a_robot_that_has_driven_on_is_sent_back(arrived: Mission) -> None:
    pose = {"id": "clearer_1", "pose": [12.0, 1.5, 0.0], "state": "idle"}
    apply(arrived, reported(2, robots=[pose]))
    again = orders(Assignment("clearer_1", OrderKind.MOVE, "b"))
    given = {order.robot: order for order in commands(arrived, again, revision=2)}
    assert (given["clearer_1"].kind, given["clearer_1"].location) == ("move", "b")


def test_what_was_done_while_the_plan_was_made_stays_done(arrived: Mission) -> None:
    apply(arrived, issued(2, done=[MOVE]))
    assert [command.id for command in arrived.done] == [MOVE.id]
    apply(arrived, issued(3, done=[], disturbed=True))
    assert arrived.done == []
    assert arrived.plan_disturbed


def test_an_order_that_was_given_up_still_counts_if_it_is_carried_out(arrived: Mission) -> None:
    apply(
        arrived,
        CommandGivenUp(time_s=2.0, robot="explorer_1", command=EXPLORE.id, reason="stands still"),
    )
    assert {pair: of.count for pair, of in arrived.failures.items()} == {
        ("explorer_1", "target_1"): 1
    }
    assert "explorer_1" not in arrived.commands
    assert arrived.plan_disturbed
    apply(arrived, reported(3, finished=[{"robot": "explorer_1", "command": EXPLORE.id}]))
    assert arrived.targets["target_1"].visited_by == "explorer_1"


def test_who_could_not_get_there_tries_again_when_nothing_else_is_left_and_the_world_has_changed(
    arrived: Mission,
) -> None:
    pair = ("explorer_1", "target_1")
    hopeless = PlanningFailed(time_s=5.0, reason="nothing to do", hopeless=True)

    def gives_up(revision: int) -> None:
        explore = command(f"r{revision}-explorer_1", "explore", "target_1")
        apply(arrived, issued(revision, done=[]).model_copy(update={"commands": [explore]}))
        given_up = {"time_s": 2.0, "robot": "explorer_1", "command": explore.id, "reason": ""}
        apply(arrived, CommandGivenUp.model_validate(given_up))

    for revision in (2, 3, 4):
        gives_up(revision)
    apply(arrived, hopeless)
    assert pair in avoided(arrived)
    assert arrived.hopeless_since_s == 5.0

    other = {"id": "c", "segment_m": [[4.0, 1.0], [5.0, 1.0]], "clear_duration_s": 9.0}
    apply(arrived, reported(2, blockades=[other]))
    assert pair in avoided(arrived), "there may be better things to do"
    apply(arrived, hopeless)
    assert pair not in avoided(arrived)
    assert arrived.hopeless_since_s is None
    assert "explorer_1 may go to target_1 again" in arrived.decisions[-1].reason

    gives_up(5)
    apply(arrived, hopeless)
    assert pair in avoided(arrived), "one attempt for each time that something is new"
    assert arrived.hopeless_since_s == 5.0


def test_orders_that_change_while_nothing_is_new_are_counted(arrived: Mission) -> None:
    before = arrived.restless
    apply(arrived, issued(2, done=[]).model_copy(update={"commands": [EXPLORE]}))
    elsewhere = command("r3-explorer_1", "explore", "target_2")
    apply(arrived, issued(3, done=[]).model_copy(update={"commands": [elsewhere]}))
    assert arrived.restless == before + 1, "the first has the explorer go on"
    apply(arrived, reported(2, finished=[{"robot": "explorer_1", "command": elsewhere.id}]))
    assert arrived.restless == 0
