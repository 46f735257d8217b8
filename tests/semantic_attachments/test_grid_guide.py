"""Poses along grid paths lead through doors."""

import numpy as np

from semantic_attachments.grid_guide import GridGuide
from semantic_attachments.outline import Outline
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.world import Blockade, GridMap

from .conftest import rooms

GRID = GridMap(rooms(), resolution_m=0.2)
DOOR = Blockade("door", ((10.1, 5.0), (10.1, 7.0)), 20.0)
CORNERS = ((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3))
MODEL = RobotModel("car", 0.5, 0.5, footprint_m=CORNERS)
OUTLINE = Outline(MODEL, GRID)
GUIDE = GridGuide(MODEL, OUTLINE, GRID, 8, lambda blockade: blockade.cells(GRID))


def test_poses_lead_through_the_door_both_ways_round() -> None:
    poses = GUIDE.poses((2.1, 2.1), (18.1, 2.1), [])
    assert poses is not None
    inside = [pose for pose in poses if abs(pose[0] - 10.1) < 0.6]
    assert inside
    assert all(5.0 < y < 7.0 for _, y, _ in inside)
    headings = np.array([pose[2] for pose in inside])
    assert (np.cos(headings) > 0.7).any()
    assert (np.cos(headings) < -0.7).any()
    assert all(OUTLINE.is_free(*pose) for pose in poses)


def test_where_the_disc_does_not_get_through_there_are_none() -> None:
    assert GUIDE.poses((2.1, 2.1), (18.1, 2.1), [DOOR]) is None
    assert GUIDE.poses((2.1, 2.1), (4.1, 8.1), [DOOR])
    assert GUIDE.poses((2.1, 2.1), (-5.0, 0.0), []) is None
