"""Meeting points at which somebody comes."""

from dataclasses import replace

import numpy as np
from carrying import CARRIER_1, carrying

from domains.mission_state import Activity, RobotState
from semantic_attachments.contract import Memory
from service.coordination.pick_up import pick_up_points
from service.coordination.strategy import Situation
from service.coordination.travel import Travel

# A hall for all, a room for rovers, and ground for all at the far end of the room.
ROOM = np.zeros((20, 60), dtype=np.bool_)
ROOM[:, 20:50] = True
SITUATION = carrying(
    ROOM,
    CARRIER_1,
    RobotState("rover_1", "rover", (4.0, 1.0)),
    meetings={"far": (5.1, 1.0), "hall": (1.9, 1.0)},
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
