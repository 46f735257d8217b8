"""Maps vegetation while driving: classified scan lines into the 3D map (sections 6.5 and 6.9.3)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.classifier import RemissionModel
from simulator.vegetation.features import measure
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.scanning import Sweep, driving_scan
from simulator.vegetation.simulation.terrain_world import TerrainWorld
from simulator.vegetation.vegetation_map import VegetationMap

Array = NDArray[np.float64]


def insert_sweep(
    vegetation_map: VegetationMap, sweep: Sweep, model: RemissionModel, setup: SensorSetup
) -> Array:
    """Classifies a sweep and adds it to the map; returns P(vegetation) `(n,)` of its points."""
    measured = measure(sweep.points_m, sweep.remission, sweep.sensor_m)
    probability = model.vegetation_probability(measured, setup)
    vegetation_map.insert(sweep.points_m, sweep.sensor_m, probability)
    return probability


def poses_along(points_m: Array, spacing_m: float) -> Array:
    """Poses `(n, 3)` every `spacing_m` along a polyline `(k, 2)`, looking where it leads."""
    steps = np.linalg.norm(np.diff(points_m, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    keep = np.concatenate([[True], steps > 1e-9])
    along, points_m = along[keep], points_m[keep]
    s = np.arange(0.0, along[-1], spacing_m)
    at = np.column_stack([np.interp(s, along, points_m[:, axis]) for axis in (0, 1)])
    ahead = np.minimum(s + 0.5, along[-1])
    behind = np.maximum(ahead - 0.6, 0.0)
    dx, dy = (
        np.interp(ahead, along, points_m[:, axis]) - np.interp(behind, along, points_m[:, axis])
        for axis in (0, 1)
    )
    return np.column_stack([at, np.arctan2(dy, dx)])


def map_while_driving(  # noqa: PLR0917
    vegetation_map: VegetationMap,
    world: TerrainWorld,
    poses: Array,
    model: RemissionModel,
    setup: SensorSetup,
    random: np.random.Generator,
    pose_noise_m: float = 0.02,
    lines_together: int = 80,
) -> Iterator[Sweep]:
    """Drives through `poses` `(n, 3)` with a fixed scanner and fills the map; yields each sweep.

    Normals are taken from `lines_together` scan lines at a time. The map is given points that are
    off by `pose_noise_m` (standard deviation, constant over such a group of lines), as localisation
    would be.
    """
    for begin in range(0, len(poses), lines_together):
        sweep = driving_scan(world, setup, poses[begin : begin + lines_together], random)
        shift = np.array([*random.normal(0.0, pose_noise_m, 2), 0.0])
        if len(sweep) < 3:
            continue
        moved = Sweep(
            sweep.points_m + shift,
            sweep.sensor_m + shift,
            sweep.remission,
            sweep.line,
            sweep.beam,
            sweep.forward_m,
            sweep.material,
            sweep.on_ground,
        )
        insert_sweep(vegetation_map, moved, model, setup)
        yield moved
