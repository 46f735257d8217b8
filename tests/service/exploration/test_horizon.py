"""Which targets carriers and rovers plan for."""

from dataclasses import replace

import numpy as np
from carrying import ABOARD, CARRIER_1, carrying

from domains.mission_state import Activity, RobotState
from semantic_attachments.contract import Memory
from service.coordination.exploration.horizon import NEAREST, within_horizon
from service.coordination.strategy import Situation

# A corridor for all below; a room that only rovers enter above its right end, behind a wall.
ROOM = np.zeros((40, 400), dtype=np.bool_)
ROOM[20:, 200:] = True
CORRIDOR = {f"corridor {index:02}": (2.0 * index + 1.0, 1.0) for index in range(19)}
IN_ROOM = {"near in the room": (21.0, 3.0), "far in the room": (39.0, 3.0)}
CARRIER = replace(CARRIER_1, position_m=(20.0, 1.0))


def exploring(*robots: RobotState) -> Situation:
    return carrying(ROOM, *robots, targets=CORRIDOR | IN_ROOM)


def chosen(situation: Situation) -> frozenset[str]:
    return within_horizon(situation, [*CORRIDOR, *IN_ROOM], Memory())


def test_the_nearest_also_where_only_its_rovers_get_to() -> None:
    near = chosen(exploring(CARRIER, ABOARD))
    assert len(near) == NEAREST
    assert "near in the room" in near
    assert not near & {"far in the room", "corridor 00", "corridor 18"}


def test_a_rover_on_the_ground_finishes_what_it_gets_to() -> None:
    on_ground = RobotState("rover_1", "rover", (25.0, 3.0))
    closed = exploring(CARRIER, on_ground)
    walled = closed.grid.cells.copy()
    walled[20, 200:] = 100
    walled[20:, 200] = 100
    grid = replace(closed.grid, cells=walled)
    near = chosen(replace(exploring(CARRIER, ABOARD), grid=grid))
    assert chosen(replace(closed, grid=grid)) == near | IN_ROOM.keys()


def test_every_carrier_has_its_own() -> None:
    second = RobotState("carrier_2", "carrier", (1.0, 1.0))
    assert "corridor 00" in chosen(exploring(CARRIER, ABOARD, second))


def test_what_is_urgent_is_never_far() -> None:
    situation = exploring(CARRIER, ABOARD)
    assert "corridor 18" in chosen(replace(situation, priorities={"corridor 18": 2}))
    assert "corridor 00" in chosen(replace(situation, deadlines_s={"corridor 00": 90.0}))


def test_all_where_nobody_is_left_to_carry() -> None:
    broken = replace(CARRIER, activity=Activity.FAILED)
    assert chosen(exploring(broken, ABOARD)) == {*CORRIDOR, *IN_ROOM}
