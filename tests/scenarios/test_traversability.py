"""Where the service lets a robot be and where the simulator's body can be: they have to agree.

Both sides measure from a cell's centre to the nearest point of an obstacle's square. A fleet asks
the service for the body's radius and the margin that its own routes keep (`MARGIN_M`), so the
service never orders a way that the body cannot drive.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import scenarios
from semantic_attachments.grid_map import GridMap
from semantic_attachments.map_server import read_map
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.robot_class import GridParameters, RobotClass
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.world import Location, World
from simulator.fleet_scenario import MARGIN_M, FleetScenario, RobotStart, RobotType
from simulator.mission_request import mission_request
from simulator.navigation import Navigation
from simulator.occupancy_grid import OccupancyGrid, read_map_server
from simulator.robot import Robot

HOSPITAL = Path(scenarios.__file__).parent / "maps" / "hospital" / "hospital.yaml"


def ordered_model(kind: RobotType, grid: OccupancyGrid) -> RobotModel:
    """The robot type as the service gets it from a fleet."""
    start = RobotStart("robot", kind.name, (0.0, 0.0, 0.0))
    fleet = FleetScenario("agreement", Path("map.yaml"), (kind,), (start,))
    return RobotModel.from_json(
        kind.name, mission_request(fleet, grid)["robot_types"][kind.name]
    )  # fmt: skip


def service_cells(model: RobotModel, grid: GridMap) -> NDArray[np.bool_]:
    """(height, width): where the attachments let the robot's centre be."""
    parameters = GridParameters()
    return RobotClass.of(model, grid, parameters).traversability(grid, (), parameters).passable()


def body_cells(kind: RobotType, grid: OccupancyGrid, margin_m: float) -> NDArray[np.bool_]:
    """(height, width): where the simulator's body stands free, on the cells' centres."""
    room_m = Navigation(grid).floor(kind).clearance_field()
    return np.asarray((room_m >= kind.radius_m + margin_m) & ~grid.forbidden(kind.enters))


@pytest.mark.parametrize("radius_m", [0.25, 0.3])
def test_the_hospital_is_the_same_for_both(radius_m: float) -> None:
    grid, kind = read_map_server(HOSPITAL), RobotType("explorer", radius_m)
    ordered = service_cells(ordered_model(kind, grid), read_map(HOSPITAL))
    assert ordered.sum() > 10_000
    np.testing.assert_array_equal(ordered, body_cells(kind, grid, MARGIN_M))
    # Without the fleet's margin the service would let the body be where it just touches, no nearer.
    bare = service_cells(RobotModel("explorer", radius_m, 1.0), read_map(HOSPITAL))
    np.testing.assert_array_equal(bare, body_cells(kind, grid, -1e-6))


def random_grid(rng: np.random.Generator) -> OccupancyGrid:
    """A small building with terrain and unknown cells."""
    cells = np.where(rng.random((24, 30)) < 0.04, 100, 0).astype(np.int8)
    cells[rng.random(cells.shape) < 0.01] = -1
    terrain = (rng.random(cells.shape) < 0.1).astype(np.uint8)
    return OccupancyGrid(cells, 0.2, (-1.0, 2.0), terrain, ("default", "rubble"))


@pytest.mark.parametrize("seed", range(12))
def test_the_body_drives_every_way_that_the_service_orders(seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = random_grid(rng)
    known = GridMap(
        grid.cells, grid.resolution_m, grid.origin_m, grid.terrain, grid.terrain_classes
    )
    kind = RobotType("explorer", float(rng.uniform(0.1, 0.45)))
    model, navigation = ordered_model(kind, grid), Navigation(grid)
    passable = service_cells(model, known)
    np.testing.assert_array_equal(passable, body_cells(kind, grid, MARGIN_M))
    inside = np.flatnonzero(passable)
    places = {
        f"place_{i}": Location(tuple(known.centres_m(rng.choice(inside, 1))[0])) for i in range(8)
    }
    costs = PathCosts(World(known, places, {"robot": model}))
    driven = 0
    for first, second in pairwise(places):
        path = [(float(x), float(y)) for x, y in costs.path("robot", first, second)]
        robot = Robot("robot", kind, *places[first].position_m, 0.0)
        if len(path) > 1 and path[0] != path[-1]:
            driven += 1
            assert navigation.accepts(robot, tuple(path)), (seed, path)
            assert navigation.route(robot, [path[-1]]) is not None
    assert driven or passable.sum() < 400
