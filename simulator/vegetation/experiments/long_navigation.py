"""Section 6.9.5: more than a kilometre on a map that was made before, with a fixed LMS 151."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.sparse.csgraph import shortest_path

from simulator import _core
from simulator.vegetation.experiments import Setting
from simulator.vegetation.experiments.report import draw_grid, draw_material, figure, save, table
from simulator.vegetation.experiments.training import trained_standing
from simulator.vegetation.mapping_drive import map_while_driving, poses_along
from simulator.vegetation.simulation.recording import EUROPA
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.worlds import Campus, CampusParameters, campus
from simulator.vegetation.terrain_grid import FREE, TerrainGrid, terrain_grid
from simulator.vegetation.vegetation_map import VegetationMap

SEED = 39
RADIUS_M, MARGIN_M, COMFORT_M = 0.45, 0.2, 0.4
LOCALISATION_M = 0.05
"""Standard deviation of the driven way from the planned one."""


def run(setting: Setting) -> str:
    """Writes `long_navigation.png` and returns the table."""
    size_m, least_m = ((60.0, 45.0), 30.0) if setting.quick else ((520.0, 330.0), 1120.0)
    spacing_m, trees = (25.0, 10) if setting.quick else (60.0, 300)
    # Few ways round: otherwise no two places of the campus are as far apart along its paths.
    place = campus(SEED, CampusParameters(size_m, spacing_m, extra_paths=0.1, trees=trees))
    model = trained_standing(EUROPA, quick=setting.quick)
    # At twice the spacing of the mapping experiment: ten scan lines a metre.
    poses = poses_along(place.tour(), 0.1)
    vegetation_map = VegetationMap()
    random = np.random.default_rng(SEED)
    beams = sum(
        len(sweep)
        for sweep in map_while_driving(vegetation_map, place.world, poses, model, EUROPA, random)
    )
    grid = terrain_grid(vegetation_map, (0.0, 0.0), place.world.size_m)
    route, goal, straight_m = _long_route(grid, place, least_m)
    driven = route + _wander(len(route), random)
    length_m = float(np.linalg.norm(np.diff(route, axis=0), axis=1).sum())
    touched = place.world.touched(driven, RADIUS_M)
    blind = _core.Floor(grid.cells == 100, grid.resolution_m, grid.origin_m)
    across = np.array(
        blind.route(tuple(route[0]), [tuple(goal)], RADIUS_M, MARGIN_M, COMFORT_M, [], [])
    )
    across_m = float(np.linalg.norm(np.diff(across, axis=0), axis=1).sum())
    over = place.world.touched(_dense(across), RADIUS_M)
    made, axes = figure(11, 7)
    draw_material(axes, place.world.material[::2, ::2], 2 * place.world.resolution_m)
    draw_grid(axes, grid)
    axes.plot(driven[:, 0], driven[:, 1], "r", lw=1.2)
    axes.plot(across[:, 0], across[:, 1], "k--", lw=0.8)
    axes.set_title("driven way (red), shortest way without the classifier (dashed)")
    save(made, setting.out / "long_navigation.png")
    return "\n".join(
        [
            "### Section 6.9.5: a long way on a map made before\n",
            f"Mapping drive of {0.1 * len(poses):,.0f} m with {beams:,} measurements; "
            f"{int((grid.cells == FREE).sum()):,} ground cells of 0.1 m. "
            f"The way is driven with an error of {LOCALISATION_M} m.\n",
            table(
                ["way", "length", "straight line", "lawn cells touched", "gravel cells touched"],
                [
                    [
                        "avoiding vegetation",
                        f"{length_m:,.0f} m",
                        f"{straight_m:.0f} m",
                        str(int((touched == Material.LAWN).sum())),
                        str(int((touched == Material.GRAVEL).sum())),
                    ],
                    [
                        "the classifier ignored (planned only)",
                        f"{across_m:,.0f} m",
                        f"{straight_m:.0f} m",
                        str(int((over == Material.LAWN).sum())),
                        str(int((over == Material.GRAVEL).sum())),
                    ],
                ],
            ),
            "![long way](long_navigation.png)\n",
        ]
    )


def _long_route(
    grid: TerrainGrid, place: Campus, least_m: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """A way through the map between two nodes that are at least `least_m` apart along the paths."""
    floor = _core.Floor(
        (grid.cells != FREE) | grid.is_vegetation(), grid.resolution_m, grid.origin_m
    )
    apart_m = _apart_m(place)
    # String pulling shortens a way by a few hundredths.
    enough = np.where(apart_m >= 1.06 * least_m, apart_m, np.inf)
    chosen = enough.argmin() if np.isfinite(enough).any() else apart_m.argmax()
    start, goal = (place.nodes_m[k] for k in np.unravel_index(chosen, apart_m.shape))
    way = floor.route(
        tuple(start.tolist()), [tuple(goal.tolist())], RADIUS_M, MARGIN_M, COMFORT_M, [], []
    )
    if way is None:
        raise RuntimeError("no way that avoids vegetation joins two nodes of the path network")
    return _dense(np.array(way)), goal, float(np.linalg.norm(goal - start))


def _apart_m(place: Campus) -> NDArray[np.float64]:
    """`(nodes, nodes)`: distances along the paths."""
    count = len(place.nodes_m)
    lengths = np.zeros((count, count))
    for a, b, line in place.paths:
        lengths[a, b] = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    return np.asarray(shortest_path(lengths, directed=False))


def _dense(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return poses_along(points, 0.05)[:, :2]


def _wander(count: int, random: np.random.Generator) -> NDArray[np.float64]:
    """An error `(count, 2)` that changes within a metre or so, as localisation's does."""
    white = random.normal(0.0, 1.0, (count, 2))
    smooth = gaussian_filter1d(white, 20.0, axis=0)
    return np.asarray(smooth / max(float(smooth.std()), 1e-12) * LOCALISATION_M)
