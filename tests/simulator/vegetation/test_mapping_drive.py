import numpy as np

from simulator.vegetation.mapping_drive import map_while_driving, poses_along
from simulator.vegetation.scores import Scores
from simulator.vegetation.simulation.recording import POWERBOT
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.worlds import street_and_lawn
from simulator.vegetation.terrain_grid import terrain_grid
from simulator.vegetation.vegetation_map import VegetationMap
from tests.simulator.vegetation.models import small_model


def test_poses_look_where_the_way_leads() -> None:
    poses = poses_along(np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 10.0]]), 0.5)
    assert len(poses) == 40
    assert np.allclose(poses[5], [2.5, 0.0, 0.0])
    assert np.allclose(poses[30], [10.0, 5.0, np.pi / 2])


def test_a_drive_maps_street_and_lawn() -> None:
    """Trained in places 1 and 2, mapped in place 31."""
    world = street_and_lawn(31, (14.0, 12.0))
    poses = poses_along(np.array([[1.0, 5.0], [10.0, 5.0]]), 0.05)
    vegetation_map = VegetationMap()
    random = np.random.default_rng(1)
    model = small_model(POWERBOT)
    sweeps = list(map_while_driving(vegetation_map, world, poses, model, POWERBOT, random))
    assert sum(len(sweep) for sweep in sweeps) > 10_000
    grid = terrain_grid(vegetation_map, (0.0, 0.0), world.size_m)
    material = world.material_at(grid.centres_m().reshape(-1, 2)).reshape(grid.cells.shape)
    known = grid.cells == 0
    scores = Scores.of(grid.is_vegetation()[known], (material == Material.LAWN)[known])
    assert scores.total > 4000
    assert scores.precision > 0.98
    assert scores.recall > 0.98
