"""Poses at which a robot can stand."""

import numpy as np

from semantic_attachments.outline import Outline
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.standing import Standing
from semantic_attachments.world import GridMap

from .conftest import rooms

GRID = GridMap(rooms(), resolution_m=0.2)
CORNERS = ((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3))
OUTLINE = Outline(RobotModel("car", 0.5, 0.5, footprint_m=CORNERS), GRID)


def test_random_poses_are_free_spread_and_seeded() -> None:
    standing = Standing(OUTLINE, GRID, headings=8)
    poses = standing.draw_many(np.random.default_rng(3), 200)
    assert len(poses) == 200
    assert all(OUTLINE.is_free(*pose) for pose in poses)
    assert poses == standing.draw_many(np.random.default_rng(3), 200)
    west = sum(x < 10 for x, _, _ in poses)
    assert 60 < west < 140


def test_there_are_none_where_there_is_no_room() -> None:
    grid = GridMap(np.full((10, 10), 100, np.int8), resolution_m=0.2)
    outline = Outline(RobotModel("car", 0.5, 0.5, footprint_m=CORNERS), grid)
    standing = Standing(outline, grid, headings=8)
    assert standing.draw_many(np.random.default_rng(3), 5) == []
    assert standing.at((1.0, 1.0)) == []


def test_a_place_has_all_headings_that_fit_there_or_beside_it() -> None:
    standing = Standing(OUTLINE, GRID, headings=8)
    assert len(standing.at((4.0, 4.0))) == 8
    beside = standing.at((9.95, 2.0))
    assert beside
    assert all(x < 9.95 and OUTLINE.is_free(x, y, h) for x, y, h in beside)
    assert [h for *_, h in Standing(OUTLINE, GRID, headings=1).at((4.0, 4.0))] == [0.0]
