"""Section 6.9.3: a vegetation map of 0.1 m from a drive of 490 m with a fixed scanner."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from simulator.vegetation.experiments import Setting
from simulator.vegetation.experiments.report import (
    draw_grid,
    draw_material,
    figure,
    percent,
    save,
    table,
)
from simulator.vegetation.experiments.training import trained_standing
from simulator.vegetation.mapping_drive import map_while_driving, poses_along
from simulator.vegetation.scores import Scores
from simulator.vegetation.simulation.recording import POWERBOT
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.terrain_world import TerrainWorld
from simulator.vegetation.simulation.worlds import CampusParameters, campus
from simulator.vegetation.terrain_grid import (
    FREE,
    TerrainGrid,
    TerrainGridParameters,
    terrain_grid,
)
from simulator.vegetation.vegetation_map import VegetationMap

SEED = 77


def run(setting: Setting) -> str:
    """Writes `mapping.png` and returns the table."""
    size_m, length_m = ((50.0, 40.0), 40.0) if setting.quick else ((120.0, 90.0), 490.0)
    place = campus(SEED, CampusParameters(size_m))
    model = trained_standing(POWERBOT, quick=setting.quick)
    poses = poses_along(place.tour(), 0.05)[: round(length_m / 0.05)]
    vegetation_map = VegetationMap()
    random = np.random.default_rng(SEED)
    beams = sum(
        len(sweep)
        for sweep in map_while_driving(vegetation_map, place.world, poses, model, POWERBOT, random)
    )
    # As measured: gaps between scan lines stay open.
    parameters = TerrainGridParameters(fill_cells=0)
    grid = terrain_grid(vegetation_map, (0.0, 0.0), place.world.size_m, parameters)
    everywhere, inside = cell_scores(grid, place.world)
    made, (left, right) = figure(13, 5, 2)
    draw_material(left, place.world.material, place.world.resolution_m)
    left.plot(poses[:, 0], poses[:, 1], "r", lw=0.8)
    draw_grid(right, grid)
    left.set_title("ground truth and drive")
    right.set_title("map: vegetation green, other ground blue")
    save(made, setting.out / "mapping.png")
    return "\n".join(
        [
            "### Section 6.9.3: vegetation map\n",
            f"{0.05 * len(poses):.0f} m driven, {beams:,} measurements, cells of 0.1 m, "
            "localisation error of 0.02 m. Overgrown gravel is neither class and is not counted.\n",
            table(
                ["cells", "number", "vegetation", "FP", "FN", "precision", "recall"],
                [
                    _row("all classified ground", everywhere),
                    _row("not within 0.1 m of a border", inside),
                    ["thesis", "271,638", "75,622", "547", "194", "99.23 %", "99.74 %"],
                ],
            ),
            "![vegetation map](mapping.png)\n",
        ]
    )


def cell_scores(grid: TerrainGrid, world: TerrainWorld) -> tuple[Scores, Scores]:
    """Of all classified cells, and of those whose neighbours are of the same class in truth."""
    shape = grid.cells.shape
    material = world.material_at(grid.centres_m().reshape(-1, 2)).reshape(shape)
    grass: NDArray[np.bool_] = material == Material.LAWN
    counted = (grid.cells == FREE) & (material != Material.GRAVEL)
    near = ndimage.maximum_filter(material, 3) != ndimage.minimum_filter(material, 3)
    found = grid.is_vegetation()
    return (
        Scores.of(found[counted], grass[counted]),
        Scores.of(found[counted & ~near], grass[counted & ~near]),
    )


def _row(name: str, scores: Scores) -> list[str]:
    return [
        name,
        f"{scores.total:,}",
        f"{scores.true_positives + scores.false_negatives:,}",
        f"{scores.false_positives:,}",
        f"{scores.false_negatives:,}",
        percent(scores.precision),
        percent(scores.recall),
    ]
