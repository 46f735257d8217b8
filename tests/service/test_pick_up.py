"""Meeting points at which somebody comes."""

from dataclasses import replace

import numpy as np

from domains.mission_state import Activity, MeetingPoint, MissionState, RobotState
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.pick_up import pick_up_points
from service.coordination.strategy import Situation
from service.coordination.travel import Travel
from service.messages.mission import PlanningMessage

# A hall for carriers, a room for rovers, and ground for carriers at the far end of the room.
TERRAIN = np.zeros((20, 60), dtype=np.uint8)
TERRAIN[:, 20:50] = 1
SITUATION = Situation(
    domain="marsupial",
    state=MissionState(
        time_s=0.0,
        robots=(
            RobotState("carrier_1", "carrier", (1.0, 1.0)),
            RobotState("rover_1", "rover", (4.0, 1.0)),
        ),
        targets=(),
        meeting_points=(MeetingPoint("far", (5.1, 1.0)), MeetingPoint("hall", (1.9, 1.0))),
        capacities={"carrier_1": 1},
    ),
    grid=GridMap(
        np.zeros(TERRAIN.shape, dtype=np.int8),
        resolution_m=0.1,
        terrain=TERRAIN,
        terrain_classes=("open", "cluttered"),
    ),
    models={
        "carrier": RobotModel("carrier", 0.2, 1.0, enters=("open",), capacity=1),
        "rover": RobotModel("rover", 0.2, 1.0, enters=("open", "cluttered")),
    },
    planning=PlanningMessage(),
    trigger="",
    exploring=True,
)


def points(situation: Situation) -> list[str]:
    return pick_up_points(situation, Travel.of(situation, Memory()))


def test_no_rover_is_to_wait_where_no_carrier_gets_to() -> None:
    assert points(SITUATION) == ["hall"]


def test_where_nobody_comes_all_are_as_good() -> None:
    carrier, rover = SITUATION.state.robots
    broken = replace(carrier, activity=Activity.FAILED)
    state = replace(SITUATION.state, robots=(broken, rover))
    assert points(replace(SITUATION, state=state)) == ["far", "hall"]
