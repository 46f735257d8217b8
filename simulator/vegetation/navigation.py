"""Drives to a goal without a prior map, and never onto vegetation (section 6.9.4)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from simulator import _core
from simulator.vegetation.classifier import RemissionModel
from simulator.vegetation.mapping_drive import insert_sweep
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.scanning import tilting_scan
from simulator.vegetation.simulation.terrain_world import TerrainWorld
from simulator.vegetation.terrain_grid import OCCUPIED, UNKNOWN, TerrainGrid, terrain_grid
from simulator.vegetation.vegetation_map import VegetationMap

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class NavigationParameters:
    """Body and habits of a robot that must not touch grass."""

    radius_m: float = 0.45
    margin_m: float = 0.15
    """Kept from vegetation and obstacles beyond the radius."""
    comfort_m: float = 0.4
    """Kept beyond that where a small detour allows it."""
    step_m: float = 2.0
    """Driven between two scans at most."""
    assumed_free_m: float = 1.4
    """The scanner does not see the ground right around the robot; where it stands is safe."""
    turn_to_scan_rad: float = 0.6
    """A way that leads off by more than this is looked at before it is driven."""
    tilt_step_rad: float = float(np.deg2rad(0.25))
    avoid_vegetation: bool = True
    """False shows what happens without the classifier."""
    most_scans: int = 400


@dataclass
class NavigationRecord:
    """What happened on the way."""

    positions_m: list[tuple[float, float]]
    """A position every few centimetres."""
    reached: bool = False
    reason: str = ""
    """Why the goal was not reached."""
    scans: int = 0
    vegetation_map: VegetationMap = field(default_factory=VegetationMap)
    grid: TerrainGrid | None = None
    """The last one planned on."""

    def length_m(self) -> float:
        """Of the driven way."""
        steps = np.diff(np.array(self.positions_m), axis=0)
        return float(np.linalg.norm(steps, axis=1).sum())


def navigate(  # noqa: PLR0917
    world: TerrainWorld,
    start: tuple[float, float, float],
    goal_m: tuple[float, float],
    model: RemissionModel,
    setup: SensorSetup,
    random: np.random.Generator,
    parameters: NavigationParameters | None = None,
) -> NavigationRecord:
    """Scans, classifies, maps, plans through what is not known to be forbidden, and drives on.

    Only ground that was seen is driven on; unseen ground counts as free when planning.
    """
    parameters = parameters or NavigationParameters()
    record = NavigationRecord([start[:2]])
    position, heading = np.array(start[:2]), start[2]
    turns = 0
    while record.scans < parameters.most_scans:
        pose = (float(position[0]), float(position[1]), float(heading))
        sweep = tilting_scan(world, setup, pose, random, parameters.tilt_step_rad)
        insert_sweep(record.vegetation_map, sweep, model, setup)
        record.scans += 1
        record.grid = terrain_grid(record.vegetation_map, (0.0, 0.0), world.size_m)
        route = _route(record, position, goal_m, parameters)
        if route is None:
            record.reason = "no way that avoids vegetation is left"
            return record
        towards = _direction(route)
        off = abs((towards - heading + np.pi) % (2 * np.pi) - np.pi)
        if off > parameters.turn_to_scan_rad and turns < 3:
            heading, turns = towards, turns + 1
            continue
        driven = _seen_part(route, record, parameters)
        if len(driven) < 2:
            if turns >= 8:
                record.reason = "the ground ahead cannot be seen"
                return record
            # A little to the side the scan lines fall between those of before.
            heading, turns = towards + random.uniform(-0.5, 0.5), turns + 1
            continue
        turns = 0
        record.positions_m += [(float(x), float(y)) for x, y in driven[1:]]
        heading = float(np.arctan2(*(driven[-1] - driven[-2])[::-1]))
        position = driven[-1]
        if np.linalg.norm(position - np.array(goal_m)) < 0.3:
            record.reached = True
            return record
    record.reason = f"not there after {parameters.most_scans} scans"
    return record


def _route(
    record: NavigationRecord,
    position: Array,
    goal_m: tuple[float, float],
    parameters: NavigationParameters,
) -> Array | None:
    """A polyline `(k, 2)` to the goal; None if every way is forbidden."""
    grid = record.grid
    assert grid is not None
    walls = grid.cells == OCCUPIED
    if parameters.avoid_vegetation:
        walls |= grid.is_vegetation()
    floor = _core.Floor(walls, grid.resolution_m, grid.origin_m)
    start = (float(position[0]), float(position[1]))
    # Pose and map are uncertain by a cell: a robot that finds itself too near backs out.
    for margin_m in (parameters.margin_m, 0.0, -0.5 * parameters.radius_m):
        found = floor.route(
            start, [goal_m], parameters.radius_m, margin_m, parameters.comfort_m, [], []
        )
        if found is not None:
            return np.array(found)
    return None


def _direction(route: Array) -> float:
    """Of the first metre of a way [rad]."""
    ahead = _resampled(route, 0.05)[:20][-1] - route[0]
    return float(np.arctan2(ahead[1], ahead[0]))


def _resampled(route: Array, spacing_m: float) -> Array:
    steps = np.linalg.norm(np.diff(route, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    s = np.append(np.arange(0.0, along[-1], spacing_m), along[-1])
    return np.column_stack([np.interp(s, along, route[:, axis]) for axis in (0, 1)])


def _seen_part(route: Array, record: NavigationRecord, parameters: NavigationParameters) -> Array:
    """The beginning of a way whose ground is known under the whole body, `step_m` at most."""
    grid = record.grid
    assert grid is not None
    points = _resampled(route, 0.05)
    points = points[: max(2, round(parameters.step_m / 0.05))]
    centres = grid.centres_m()
    stood = np.array(record.positions_m[:1] + record.positions_m[-1:])
    unknown = grid.cells == UNKNOWN
    for place in stood:
        unknown &= np.linalg.norm(centres - place, axis=-1) > parameters.assumed_free_m
    away_m = ndimage.distance_transform_edt(~unknown) * grid.resolution_m
    index = np.floor((points - np.array(grid.origin_m)) / grid.resolution_m).astype(int)
    blocked = away_m[index[:, 1], index[:, 0]] < parameters.radius_m
    end = int(np.argmax(blocked)) if blocked.any() else len(points)
    return points[:end]
