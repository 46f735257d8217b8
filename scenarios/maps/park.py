"""A park as a carrier's laser knows it: surveyed, classified, and cut into terrain classes.

Ground truth is a simulated campus. A robot with a fixed LMS 291 drives its paths; what the
classifier makes of the measurements is the map that the fleet and the service get, errors and all.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from scenarios.maps.files import write_map, write_terrain
from simulator.vegetation.classifier import RemissionModel
from simulator.vegetation.experiments.training import trained_standing
from simulator.vegetation.mapping_drive import map_while_driving, poses_along
from simulator.vegetation.simulation.recording import POWERBOT
from simulator.vegetation.simulation.worlds import Campus, CampusParameters, campus
from simulator.vegetation.terrain_grid import (
    FREE,
    TERRAIN_CLASSES,
    VEGETATION,
    TerrainGrid,
    TerrainGridParameters,
    terrain_grid,
)
from simulator.vegetation.vegetation_map import VegetationMap

CARRIER_RADIUS_M = 0.4
VERGE_M = CARRIER_RADIUS_M + 0.2
"""The radius of a carrier and the width of a cell of the map."""
TARGET_CLEARANCE_M = 0.7


@dataclass(frozen=True)
class Survey:
    """What the survey of a park found, and the park itself."""

    place: Campus
    grid: TerrainGrid
    """Cells of 0.2 m."""
    targets_m: NDArray[np.float64]
    """`(n, 2)`: places to visit, on grass and on pavement."""


def park(seed: int) -> Campus:
    """Ground truth: 60 x 45 m of lawn with paths, trees and a hedge."""
    return campus(seed, CampusParameters((60.0, 45.0), spacing_m=24.0, gravel_patches=1, trees=12))


def survey(seed: int, model: RemissionModel | None = None) -> Survey:
    """Drives all paths of a park with a scanner and classifies what it sees."""
    place = park(seed)
    model = model or trained_standing(POWERBOT, quick=False)
    vegetation_map = VegetationMap()
    poses = poses_along(place.tour(), 0.05)
    random = np.random.default_rng([seed, 12])
    for _ in map_while_driving(vegetation_map, place.world, poses, model, POWERBOT, random):
        pass
    fine = terrain_grid(
        vegetation_map, (0.0, 0.0), place.world.size_m, TerrainGridParameters(fill_cells=3)
    )
    grid = fine.without_specks(0.3).coarser(2).without_specks(2.0)
    return Survey(place, grid, _targets(grid, seed))


def write_survey(found: Survey, folder: Path, name: str) -> Path:
    """Writes map, terrain and targets; returns the path of the map's YAML file."""
    grid = found.grid
    path = write_map(folder, name, grid.cells, grid.resolution_m, grid.origin_m)
    write_terrain(path, grid.terrain(VERGE_M), TERRAIN_CLASSES)
    lines = ["# Places to visit; positions in the map frame [m]."]
    for number, (x, y) in enumerate(found.targets_m.tolist(), 1):
        lines += ["", "[[targets]]", f'id = "target_{number}"', f"position_m = [{x:.1f}, {y:.1f}]"]
    (folder / f"{name}.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _targets(
    grid: TerrainGrid, seed: int, on_grass: int = 8, on_paths: int = 4
) -> NDArray[np.float64]:
    """Places with room for a robot, far from each other, connected to the largest open piece."""
    room_m = ndimage.distance_transform_edt(grid.cells == FREE) * grid.resolution_m
    pieces, _ = ndimage.label(room_m > TARGET_CLEARANCE_M)
    largest = pieces == np.bincount(pieces.ravel())[1:].argmax() + 1
    terrain = grid.terrain(VERGE_M)
    grass_m = ndimage.distance_transform_edt(terrain == VEGETATION) * grid.resolution_m
    paved_m = ndimage.distance_transform_edt(terrain == 0) * grid.resolution_m
    random = np.random.default_rng([seed, 13])
    centres = grid.centres_m()
    chosen: list[NDArray[np.float64]] = []
    for wanted, fits in ((on_grass, grass_m > 1.2), (on_paths, paved_m > 0.5)):
        candidates = random.permutation(centres[largest & fits])
        count = len(chosen) + wanted
        for candidate in candidates:
            apart = [float(np.linalg.norm(candidate - other)) for other in chosen]
            if len(chosen) < count and min(apart, default=np.inf) > 5.0:
                chosen.append(candidate)
    return np.array(chosen)
