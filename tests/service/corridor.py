"""A corridor of 40 m by 3 m, in which what a strategy should answer can be told by eye."""

import numpy as np

from domains.mission_state import BlockadeState, MissionState, RobotState, Target
from semantic_attachments.grid_map import GridMap
from semantic_attachments.robot_model import RobotModel
from service.coordination.strategy import Situation
from service.messages.mission import PlanningMessage


def corridor(
    explorers: dict[str, float],
    clearers: dict[str, float],
    targets: dict[str, float],
    blockades: dict[str, float] | None = None,
    arrived: dict[str, str] | None = None,
) -> Situation:
    """Robots, targets and blockades along the middle of the corridor, all at the given x [m]."""
    cells = np.full((16, 162), 100, dtype=np.int8)
    cells[2:14, 1:161] = 0
    types = {"explorer": explorers, "clearer": clearers}
    return Situation(
        domain="disaster",
        state=MissionState(
            time_s=0.0,
            robots=tuple(
                RobotState(name, kind, (x, 2.0), arrived_at=(arrived or {}).get(name))
                for kind, team in types.items()
                for name, x in team.items()
            ),
            targets=tuple(Target(name, (x, 2.0)) for name, x in targets.items()),
            blockades=tuple(
                BlockadeState(name, ((x, 0.4), (x, 3.6)), 20.0)
                for name, x in (blockades or {}).items()
            ),
        ),
        grid=GridMap(cells, 0.25),
        models={kind: RobotModel(kind, 0.3, 1.0) for kind in types},
        planning=PlanningMessage(node_limit=2000, time_limit_s=10.0),
        trigger="a test",
    )
