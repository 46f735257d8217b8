import numpy as np

from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.terrain_world import TerrainWorld

WORLD = TerrainWorld(
    np.array(
        [[Material.ASPHALT, Material.LAWN], [Material.GRAVEL, Material.LIGHT_TILES]], np.uint8
    ),
    1.0,
    seed=1,
)


def test_positions_find_their_cells() -> None:
    at = np.array([[0.5, 0.5], [1.5, 0.5], [0.5, 1.5], [1.9, 1.1], [9.0, -3.0]])
    expected = [
        Material.ASPHALT,
        Material.LAWN,
        Material.GRAVEL,
        Material.LIGHT_TILES,
        Material.LAWN,
    ]
    assert WORLD.material_at(at).tolist() == expected


def test_classes_of_ground() -> None:
    assert WORLD.vegetation().tolist() == [[False, True], [False, False]]
    assert WORLD.paved().tolist() == [[True, False], [False, True]]
    assert WORLD.size_m == (2.0, 2.0)


def test_a_disc_touches_cells_whose_centre_it_covers() -> None:
    at = np.array([[0.6, 0.5]])
    assert WORLD.touched(at, 0.3).tolist() == [Material.ASPHALT]
    assert sorted(WORLD.touched(at, 0.95).tolist()) == [Material.ASPHALT, Material.LAWN]
    assert len(WORLD.touched(np.array([[0.6, 0.5], [0.7, 0.5]]), 0.3)) == 1


def test_the_ground_undulates_gently() -> None:
    x = np.column_stack([np.arange(0, 50, 0.1), np.zeros(500)])
    height = WORLD.ground_m(x)
    assert 0.001 < height.std() < 0.1
    assert np.abs(np.diff(height)).max() < 0.01
