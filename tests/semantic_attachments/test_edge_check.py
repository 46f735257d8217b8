"""Edges are checked against walls and against blockades."""

import math

import pytest

from semantic_attachments.edge_check import EdgeCheck
from semantic_attachments.outline import Outline
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.steering import steering
from semantic_attachments.world import Blockade, GridMap

from .conftest import rooms

GRID = GridMap(rooms(), resolution_m=0.2)
DOOR = Blockade("door", ((10.1, 5.0), (10.1, 7.0)), 20.0)
MODEL = RobotModel("robot", radius_m=0.4, speed_m_s=0.5)
WEST, EAST = (7.0, 6.0, 0.0), (13.0, 6.0, 0.0)
BESIDE = (9.65, 6.0, 0.0)


@pytest.fixture
def check() -> EdgeCheck:
    return EdgeCheck(Outline(MODEL, GRID), steering(MODEL, 8), GRID)


def test_a_wall_is_in_the_way_and_a_door_is_not(check: EdgeCheck) -> None:
    assert check.is_free((0, 1), (WEST, EAST))
    assert not check.is_free((2, 3), ((7.0, 2.0, 0.0), (13.0, 2.0, 0.0)))


def test_an_edge_is_asked_once_in_both_directions(check: EdgeCheck) -> None:
    assert check.is_free((0, 1), (WEST, EAST))
    nowhere = (math.nan, math.nan, 0.0)
    assert check.is_free((1, 0), (nowhere, nowhere))


def test_a_blockade_is_touched_save_where_a_robot_leaves_it(check: EdgeCheck) -> None:
    def touches(edge: tuple[int, int], *ends: tuple[float, float, float], **parting: bool) -> bool:
        both = {"leaves": False, "arrives": False} | parting
        return check.touches(edge, (ends[0], ends[1]), DOOR, **both)

    assert touches((0, 1), WEST, EAST)
    assert not touches((0, 2), WEST, (8.0, 6.0, 0.0))
    assert touches((3, 0), BESIDE, WEST)
    assert not touches((3, 0), BESIDE, WEST, leaves=True)
    assert touches((3, 1), BESIDE, EAST, leaves=True)
    assert not touches((0, 3), WEST, BESIDE, arrives=True)
