"""Maps for the tests of this room."""

import numpy as np
import pytest
from numpy.typing import NDArray

from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World


def rooms(columns: int = 100, rows: int = 60) -> NDArray[np.int8]:
    """Two rooms side by side, joined by a door of ten cells in the middle of their common wall."""
    cells = np.zeros((rows, columns), np.int8)
    cells[0] = cells[-1] = 100
    cells[:, 0] = cells[:, -1] = 100
    cells[:, columns // 2] = 100
    cells[rows // 2 - 5 : rows // 2 + 5, columns // 2] = 0
    return cells


@pytest.fixture
def two_rooms() -> World:
    """A place in each room, a blockade in the door between them, a robot."""
    door = Blockade("door", ((10.1, 5.0), (10.1, 7.0)), clear_duration_s=20.0)
    return World(
        grid=GridMap(rooms(), resolution_m=0.2),
        locations={
            "west": Location((2.1, 2.1)),
            "also_west": Location((4.1, 8.1)),
            "east": Location((18.1, 2.1)),
            "door": Location(door.centre_m, blockade="door"),
        },
        robots={"robot": RobotModel("explorer", radius_m=0.3, speed_m_s=0.5)},
        blockades={"door": door},
    )
