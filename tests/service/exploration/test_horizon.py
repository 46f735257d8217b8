"""Which targets carriers and rovers plan for."""

from dataclasses import replace

import numpy as np

from domains.mission_state import Activity, MissionState, RobotState, Target
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.exploration.horizon import NEAREST, within_horizon
from service.coordination.strategy import Situation
from service.messages.mission import PlanningMessage

# A corridor for carriers below; a room that only rovers enter above its right end.
TERRAIN = np.zeros((40, 400), dtype=np.uint8)
TERRAIN[20:, 200:] = 1
CORRIDOR = {f"corridor {index:02}": (2.0 * index + 1.0, 1.0) for index in range(19)}
ROOM = {"near in the room": (21.0, 3.0), "far in the room": (39.0, 3.0)}
CARRIER = RobotState("carrier_1", "carrier", (20.0, 1.0))
ABOARD = RobotState("rover_1", "rover", (20.0, 1.0), Activity.DOCKED, "carrier_1")
ON_GROUND = RobotState("rover_1", "rover", (25.0, 3.0))
SITUATION = Situation(
    domain="marsupial",
    state=MissionState(
        time_s=0.0,
        robots=(CARRIER, ABOARD),
        targets=tuple(Target(name, place_m) for name, place_m in (CORRIDOR | ROOM).items()),
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
        "rover": RobotModel("rover", 0.2, 1.0, enters=("cluttered",)),
    },
    planning=PlanningMessage(),
    trigger="",
    exploring=True,
)


def chosen(*robots: RobotState, **others: object) -> frozenset[str]:
    situation = replace(SITUATION, state=replace(SITUATION.state, robots=robots), **others)  # type: ignore[arg-type]
    return within_horizon(situation, [*CORRIDOR, *ROOM], Memory())


def test_the_nearest_also_where_only_its_rovers_get_to() -> None:
    near = chosen(CARRIER, ABOARD)
    assert len(near) == NEAREST
    assert "near in the room" in near
    assert not near & {"far in the room", "corridor 00", "corridor 18"}


def test_a_rover_on_the_ground_finishes_what_it_gets_to() -> None:
    assert chosen(CARRIER, ON_GROUND) == chosen(CARRIER, ABOARD) | {"far in the room"}


def test_every_carrier_has_its_own() -> None:
    second = RobotState("carrier_2", "carrier", (1.0, 1.0))
    assert "corridor 00" in chosen(CARRIER, ABOARD, second)


def test_what_is_urgent_is_never_far() -> None:
    assert "corridor 18" in chosen(CARRIER, ABOARD, priorities={"corridor 18": 2})
    assert "corridor 00" in chosen(CARRIER, ABOARD, deadlines_s={"corridor 00": 90.0})


def test_all_where_nobody_is_left_to_carry() -> None:
    broken = replace(CARRIER, activity=Activity.FAILED)
    assert chosen(broken, ABOARD) == frozenset([*CORRIDOR, *ROOM])
