import numpy as np

from simulator.vegetation.terrain_grid import TerrainGrid, terrain_grid
from simulator.vegetation.vegetation_map import VegetationMap

ABOVE = np.array([0.0, 0.0, 0.02])
"""The scanner is in the same voxel, so that no beam frees what another one hit."""


def filled_map(height: float = 0.0) -> VegetationMap:
    """2 m x 2 m of ground, grass beyond x = 1, with a post at (0.55, 0.55) of 1 m."""
    x, y = np.meshgrid(np.arange(0.05, 2, 0.1), np.arange(0.05, 2, 0.1))
    ground = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height + 0.05)])
    post = np.array([[0.55, 0.55, height + z] for z in np.arange(0.15, 1.0, 0.1)])
    vegetation_map = VegetationMap()
    points = np.concatenate([ground, post])
    grass = np.where(points[:, 0] > 1, 0.9, 0.1)
    grass[len(ground) :] = np.nan
    for point, p in zip(points, grass, strict=True):
        vegetation_map.insert(point[None], point + ABOVE, np.array([p]))
    return vegetation_map


def test_ground_grass_and_obstacles() -> None:
    for height in (0.0, 1.3):
        grid = terrain_grid(filled_map(height), (0.0, 0.0), (2.0, 2.0))
        assert grid.cells.shape == (20, 20)
        assert np.argwhere(grid.cells == 100).tolist() == [[5, 5]]
        assert (grid.cells == 0).sum() == 399
        vegetation = grid.is_vegetation()
        assert vegetation[:, 10:].all()
        assert not vegetation[:, :10].any()
        assert grid.terrain().sum() == 200


def test_what_is_not_seen_is_unknown() -> None:
    grid = terrain_grid(filled_map(), (-1.0, 0.0), (3.5, 2.0))
    assert (grid.cells[:, :10] == -1).all()
    assert (grid.cells[:, 31:] == -1).all()
    assert grid.centres_m()[0, 0].round(6).tolist() == [-0.95, 0.05]


def test_gaps_between_scan_lines_are_filled_with_the_worse_neighbour() -> None:
    vegetation_map = VegetationMap()
    for x in np.arange(0.05, 1.0, 0.1):
        for y, p in ((0.05, 0.1), (0.25, 0.9)):
            point = np.array([[x, y, 0.05]])
            vegetation_map.insert(point, point + ABOVE, np.array([p]))
    grid = terrain_grid(vegetation_map, (0.0, 0.0), (1.0, 0.3))
    assert (grid.cells == 0).all()
    assert grid.is_vegetation()[1].all()
    assert not grid.is_vegetation()[0].any()


def test_coarser_cells_take_the_worst() -> None:
    cells = np.array([[0, 0, 0, 100], [0, 0, 0, 0], [-1, -1, 0, -1], [-1, -1, 0, -1]], np.int8)
    chance = np.where(cells == 0, 0.1, np.nan)
    chance[0, 1] = 0.9
    grid = TerrainGrid(cells, chance, 0.1, (0.0, 0.0)).coarser(2)
    assert grid.cells.tolist() == [[0, 100], [-1, 0]]
    assert grid.is_vegetation().tolist() == [[True, False], [False, False]]
    assert grid.resolution_m == 0.2


def test_the_verge_keeps_wheels_off_the_grass() -> None:
    chance = np.full((6, 20), 0.1)
    chance[:, 12:] = 0.9
    grid = TerrainGrid(np.zeros((6, 20), np.int8), chance, 0.1, (0.0, 0.0))
    assert grid.terrain(0.35)[0].tolist() == [0] * 9 + [2] * 3 + [1] * 8
    assert (grid.terrain()[0] == chance[0].round()).all()


def test_specks_take_the_class_around_them() -> None:
    chance = np.full((20, 20), 0.1)
    chance[:, 10:] = 0.9
    chance[3, 3] = 0.9
    chance[5:7, 15:17] = 0.1
    chance[10:14, 2:6] = 0.9
    grid = TerrainGrid(np.zeros((20, 20), np.int8), chance, 0.1, (0.0, 0.0))
    found = grid.without_specks(0.1).is_vegetation()
    assert found[:, 10:].all()
    assert found[:, :10].sum() == 16
