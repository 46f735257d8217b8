"""Robots that a plan does not need."""

from dataclasses import replace

import numpy as np

from domains.formulation import Assignment, OrderKind
from domains.mission_state import Activity, MeetingPoint, MissionState, RobotState, Target
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.idle_robots import with_idle_robots
from service.coordination.strategy import Situation
from service.messages.mission import PlanningMessage

MODELS = {
    "carrier": RobotModel("carrier", 0.3, 1.0, capacity=1),
    "rover": RobotModel("rover", 0.3, 1.0),
}
EXPLORATION = Situation(
    domain="marsupial",
    state=MissionState(
        time_s=0.0,
        robots=(
            RobotState("carrier_1", "carrier", (5.0, 5.0)),
            RobotState("rover_1", "rover", (2.0, 2.0)),
            RobotState("rover_2", "rover", (5.0, 5.0), Activity.DOCKED, "carrier_1"),
        ),
        targets=(Target("frontier:1", (9.0, 9.0)),),
        meeting_points=(
            MeetingPoint("meeting far", (9.0, 2.0)),
            MeetingPoint("meeting near", (3.0, 2.0)),
        ),
        capacities={"carrier_1": 1},
    ),
    grid=GridMap(np.zeros((100, 100), dtype=np.int8), resolution_m=0.1),
    models=MODELS,
    planning=PlanningMessage(),
    trigger="",
    exploring=True,
)


def test_an_idle_rover_goes_to_the_nearest_meeting_point() -> None:
    (order,) = with_idle_robots([], EXPLORATION, Memory())
    assert (order.robot, order.kind, order.location) == ("rover_1", OrderKind.MOVE, "meeting near")


def test_one_that_is_there_or_has_work_does_not() -> None:
    work = [Assignment("rover_1", OrderKind.EXPLORE, "frontier:1")]
    assert with_idle_robots(work, EXPLORATION, Memory()) == work
    state = EXPLORATION.state
    there = tuple(replace(robot, arrived_at="meeting far") for robot in state.robots)
    arrived = replace(EXPLORATION, state=replace(state, robots=there))
    assert with_idle_robots([], arrived, Memory()) == []


def test_where_all_is_known_rovers_stay() -> None:
    assert with_idle_robots([], replace(EXPLORATION, exploring=False), Memory()) == []
