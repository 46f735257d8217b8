"""One action a robot, for teams of carriers and rovers."""

from dataclasses import replace

import numpy as np
from carrying import carrying

from domains.mission_state import RobotState
from semantic_attachments.contract import Memory
from service.coordination.one_step_marsupial import RESTLESS_FROM, OneStepMarsupial
from service.coordination.strategy import Situation

# A hall for carriers, and two rooms above it that only rovers enter.
ROOMS = np.zeros((40, 100), dtype=np.bool_)
ROOMS[20:, :40] = ROOMS[20:, 80:] = True


def orders(situation: Situation) -> dict[str, tuple[str, str | None]]:
    proposal = OneStepMarsupial().propose(situation, Memory())
    return {order.robot: (order.kind.value, order.location) for order in proposal.assignments}


def test_carriers_that_change_places_for_long_keep_their_targets() -> None:
    """The one that has come for a rover is nearer to where the other is going, and so on."""
    situation = carrying(
        ROOMS,
        RobotState("carrier_1", "carrier", (2.0, 1.7), arrived_at="left"),
        RobotState("carrier_2", "carrier", (6.0, 1.0)),
        RobotState("rover_1", "rover", (2.0, 2.3), arrived_at="left"),
        targets={"hall": (5.0, 1.0), "room": (9.0, 3.0)},
        meetings={"left": (2.0, 1.9), "right": (9.0, 1.9)},
    )
    rover = replace(situation.models["rover"], enters=("cluttered",))
    situation = replace(
        situation,
        models={**situation.models, "rover": rover},
        going={"carrier_1": "left", "carrier_2": "hall"},
    )
    anew = orders(situation)
    assert (anew["carrier_1"], anew["carrier_2"]) == (("explore", "hall"), ("move", "left"))
    kept = orders(replace(situation, restless=RESTLESS_FROM))
    assert kept["carrier_2"] == ("explore", "hall")
    assert kept["carrier_1"] == kept["rover_1"] == ("dock", "left")
