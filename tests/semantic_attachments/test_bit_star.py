"""BIT* shortens a motion, and never lengthens it."""

import numpy as np
import pytest

from semantic_attachments.bit_star import shortened
from semantic_attachments.motion_space import MotionSpace, quiet_and_seeded
from semantic_attachments.outline import Outline
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.rrt_connect import connect
from semantic_attachments.world import GridMap

from .conftest import rooms

GRID = GridMap(rooms(), resolution_m=0.2)
START, GOAL = (2.1, 2.1, 0.0), (18.1, 2.1, 0.0)

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def space(kinematics: str) -> tuple[MotionSpace, Outline]:
    quiet_and_seeded(0)
    corners = ((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3))
    model = RobotModel("car", 0.5, 0.5, kinematics=kinematics, footprint_m=corners)
    outline = Outline(model, GRID)
    return MotionSpace(model, GRID, outline.is_free), outline


@pytest.mark.parametrize("kinematics", ["se2", "dubins", "reeds-shepp"])
def test_what_rrt_connect_finds_is_free_and_gets_shorter(kinematics: str) -> None:
    motions, outline = space(kinematics)
    found = connect(motions, [START], [GOAL], 2.0)
    assert found[0] == pytest.approx(START)
    assert found[-1] == pytest.approx(GOAL)
    shorter = shortened(motions, found, 0.4)
    assert motions.length_m(shorter) <= motions.length_m(found)
    assert shorter[0] == pytest.approx(START)
    assert shorter[-1] == pytest.approx(GOAL)
    assert outline.all_free(np.array(shorter))
    assert motions.length_m(shorter) >= 16.0


def test_a_detour_is_cut_short() -> None:
    motions, _ = space("reeds-shepp")
    detour = [START, (2.1, 9.0, 1.5), (8.0, 9.0, 0.0), (8.1, 2.1, 0.0)]
    assert motions.length_m(shortened(motions, detour, 0.4)) < 0.7 * motions.length_m(detour)


def test_without_a_way_there_is_none() -> None:
    motions, _ = space("reeds-shepp")
    walled_in = (10.1, 1.0, 0.0)
    assert connect(motions, [START], [walled_in], 0.1) == []
    same = [START, (3.0, 2.1, 0.0)]
    assert motions.length_m(shortened(motions, same, 0.05)) == pytest.approx(0.9)
