"""Carriers reach a threshold before every cluttered area, rovers every place behind it."""

import numpy as np
import pytest

from scenarios.maps import maze, office
from scenarios.maps.floor_plan import FREE, UNKNOWN, FloorPlan
from scenarios.maps.free_space import components
from scenarios.maps.terrain import CLUTTERED, OPEN, THRESHOLD, terrain_cells


@pytest.mark.parametrize("plan", [maze.draw(1), maze.draw(2), office.draw(1), office.draw(2)])
def test_every_cluttered_area_has_a_meeting_place(plan: FloorPlan) -> None:
    cells, terrain = plan.cells(), terrain_cells(plan)
    assert terrain is not None

    def reach(*classes: int, clearance_m: float) -> np.ndarray:
        walls = np.where((cells == FREE) & ~np.isin(terrain, classes), UNKNOWN, cells)
        return components(walls.astype(np.int8), plan.resolution_m, clearance_m)

    carriers = reach(OPEN, THRESHOLD, clearance_m=0.4)
    rovers = reach(CLUTTERED, THRESHOLD, clearance_m=0.25)
    assert set(np.unique(carriers[terrain == OPEN])) <= {0, 1}
    meeting = (carriers == 1) & (terrain == THRESHOLD)
    for area in np.unique(rovers[(cells == FREE) & (terrain == CLUTTERED) & (rovers > 0)]):
        assert (meeting & (rovers == area)).any()


def test_the_maze_has_eight_openings() -> None:
    terrain = terrain_cells(maze.draw(3))
    assert terrain is not None
    boxes = [box for box, kind in maze.draw(3).terrain if kind == THRESHOLD]
    assert len(boxes) == 8
    assert (terrain == THRESHOLD).any()


def test_floors_without_clutter_have_no_terrain() -> None:
    assert terrain_cells(FloorPlan("plain", width=10, height=10, resolution_m=0.2)) is None
