"""An exploration with carriers and rovers on ground that either or both of them enter."""

import numpy as np
from numpy.typing import NDArray

from domains.mission_state import Activity, MeetingPoint, MissionState, RobotState, Target
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.strategy import Situation
from service.messages.mission import PlanningMessage

CARRIER_1 = RobotState("carrier_1", "carrier", (1.0, 1.0))
ABOARD = RobotState("rover_1", "rover", (1.0, 1.0), Activity.DOCKED, "carrier_1")


def carrying(
    cluttered: NDArray[np.bool_],
    *robots: RobotState,
    targets: dict[str, tuple[float, float]] | None = None,
    meetings: dict[str, tuple[float, float]] | None = None,
) -> Situation:
    """Free ground in cells of 0.1 m: where it is cluttered for rovers only, elsewhere for all."""
    return Situation(
        domain="marsupial",
        state=MissionState(
            time_s=0.0,
            robots=robots,
            targets=tuple(Target(name, place) for name, place in (targets or {}).items()),
            meeting_points=tuple(MeetingPoint(name, at) for name, at in (meetings or {}).items()),
            capacities={robot.id: 1 for robot in robots if robot.type == "carrier"},
        ),
        grid=GridMap(
            np.zeros(cluttered.shape, dtype=np.int8),
            resolution_m=0.1,
            terrain=cluttered.astype(np.uint8),
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
