"""Simulated 3D scans: a scan line for each pose and tilt, traced against a terrain world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.remission_model import (
    GRASS_IN_GRAVEL,
    SCANNERS,
    SURFACES,
    Material,
    Scanner,
    remission,
)
from simulator.vegetation.simulation.terrain_world import TerrainWorld

Array = NDArray[np.float64]
MAX_RANGE_M = 8.0
"""Simulated returns end here; the classifiers look at less."""


@dataclass(frozen=True)
class Sweep:
    """What a scanner measured in some scan lines; `(n,)` beams that came back."""

    points_m: Array
    """`(n, 3)` in the map frame, as measured."""
    sensor_m: Array
    """`(n, 3)`: where the scanner was."""
    remission: Array
    line: NDArray[np.intp]
    """Number of the scan line that a beam belongs to."""
    beam: NDArray[np.intp]
    """Its number in the line."""
    forward_m: Array
    """Coordinate of the end point along the viewing direction, in the scan plane."""
    material: NDArray[np.uint8]
    """Truth: what the beam hit."""
    on_ground: NDArray[np.bool_]
    """Truth: whether that was the ground."""

    def __len__(self) -> int:
        return len(self.points_m)

    def range_m(self) -> Array:
        """Measured ranges `(n,)`."""
        return np.asarray(np.linalg.norm(self.points_m - self.sensor_m, axis=1))


def tilting_scan(
    world: TerrainWorld,
    setup: SensorSetup,
    pose: tuple[float, float, float],
    random: np.random.Generator,
    tilt_step_rad: float = np.deg2rad(0.5),
) -> Sweep:
    """One sweep of the tilt unit from a standing robot; `pose` is x, y [m] and heading [rad]."""
    low, high = setup.tilt_rad
    tilts = np.arange(low, high + 1e-9, tilt_step_rad)
    poses = np.tile(np.asarray(pose, dtype=np.float64), (len(tilts), 1))
    return scan_lines(world, setup, poses, tilts, random)


def driving_scan(
    world: TerrainWorld,
    setup: SensorSetup,
    poses: Array,
    random: np.random.Generator,
) -> Sweep:
    """One scan line at each pose `(n, 3)` of a driving robot with a scanner at a fixed angle."""
    return scan_lines(world, setup, poses, np.full(len(poses), setup.tilt_rad[0]), random)


def scan_lines(
    world: TerrainWorld,
    setup: SensorSetup,
    poses: Array,
    tilts_rad: Array,
    random: np.random.Generator,
) -> Sweep:
    """One scan line for each pose `(n, 3)` and tilt below the horizontal `(n,)`.

    The platform stays level; its scanner is `setup.height_m` above the ground under it.
    """
    scanner = SCANNERS[setup.scanner]
    angles = _beam_angles(scanner)
    line, beam = (axis.ravel() for axis in np.indices((len(poses), len(angles))))
    azimuth, tilt = angles[beam], tilts_rad[line]
    forward, left = np.cos(azimuth), np.sin(azimuth)
    heading = poses[line, 2]
    flat = forward * np.cos(tilt)
    directions = np.column_stack(
        [
            flat * np.cos(heading) - left * np.sin(heading),
            flat * np.sin(heading) + left * np.cos(heading),
            -forward * np.sin(tilt),
        ]
    )
    sensor = np.column_stack([poses[:, :2], world.ground_m(poses[:, :2]) + setup.height_m])[line]
    range_m, material, normals, on_ground = _trace(world, sensor, directions, random)
    hit = np.isfinite(range_m)
    line, beam, sensor, directions = line[hit], beam[hit], sensor[hit], directions[hit]
    range_m, material, normals = range_m[hit], material[hit], normals[hit]
    cosine = np.abs(np.einsum("ni,ni->n", directions, normals))
    reported = remission(
        scanner, material, range_m, np.arccos(np.minimum(cosine, 1.0)), world.reflectance(), random
    )
    relief = np.array([SURFACES[kind].relief_m for kind in Material])[material]
    measured_m = range_m + random.normal(0.0, 1.0, len(range_m)) * scanner.range_noise_m
    # Blades and grains end a beam earlier or later, the more the flatter it comes in.
    measured_m += random.normal(0.0, 1.0, len(range_m)) * relief / np.maximum(cosine, 0.1)
    measured_m = np.maximum(measured_m, 0.05)
    return Sweep(
        sensor + directions * measured_m[:, None],
        sensor,
        reported,
        line,
        beam,
        measured_m * np.cos(angles[beam]),
        material,
        on_ground[hit],
    )


def _beam_angles(scanner: Scanner) -> Array:
    """Of one line, from right to left; beams that cannot point forward are left out."""
    half = min(scanner.field_of_view_rad / 2, np.pi / 2)
    # Steps finer than the LMS 291's only repeat what neighbouring beams see: thinned to 1 degree.
    step = max(scanner.beam_step_rad, np.pi / 180)
    return np.arange(-half, half + 1e-9, step)


def _trace(
    world: TerrainWorld, sensor: Array, directions: Array, random: np.random.Generator
) -> tuple[Array, NDArray[np.uint8], Array, NDArray[np.bool_]]:
    """Range (infinite without a return), material, surface normal, and whether it is the ground."""
    range_m, normals = _trace_ground(world, sensor, directions)
    end = (sensor + directions * np.where(np.isfinite(range_m), range_m, 0.0)[:, None])[:, :2]
    width, height = world.size_m
    outside = (end < 0).any(axis=1) | (end[:, 0] >= width) | (end[:, 1] >= height)
    range_m = np.where(outside, np.inf, range_m)
    material = world.material_at(end)
    overgrown = (material == Material.GRAVEL) & (random.random(len(material)) < GRASS_IN_GRAVEL)
    material = np.where(overgrown, np.uint8(Material.LAWN), material)
    on_ground = np.isfinite(range_m)
    near = sensor[:, :2].mean(axis=0)
    spread = np.linalg.norm(sensor[:, :2] - near, axis=1).max() + MAX_RANGE_M
    for trace, shapes in ((_trace_cylinder, world.cylinders), (_trace_box, world.boxes)):
        for shape in shapes[_within(shapes, near, spread)]:
            distance, normal = trace(shape, sensor, directions)
            closer = distance < range_m
            range_m = np.where(closer, distance, range_m)
            material = np.where(closer, np.uint8(shape[-1]), material)
            normals[closer] = normal[closer]
            on_ground &= ~closer
    range_m = np.where(range_m > MAX_RANGE_M, np.inf, range_m)
    return range_m, material, normals, on_ground


def _within(shapes: Array, near: Array, spread: float) -> NDArray[np.bool_]:
    """Shapes that a beam of a sweep around `near` can reach."""
    if shapes.shape[1] == 5:
        return np.asarray(np.linalg.norm(shapes[:, :2] - near, axis=1) < spread + shapes[:, 2])
    low, high = shapes[:, [0, 2]], shapes[:, [1, 3]]
    nearest = np.clip(near, low, high)
    return np.asarray(np.linalg.norm(nearest - near, axis=1) < spread)


def _trace_ground(world: TerrainWorld, sensor: Array, directions: Array) -> tuple[Array, Array]:
    falling = directions[:, 2] < -0.02
    slope = np.where(falling, -directions[:, 2], 1.0)
    floor = world.ground_m(sensor[:, :2])
    distance = (sensor[:, 2] - floor) / slope
    # The ground undulates by centimetres over metres: few fixed-point steps find where a beam ends.
    for _ in range(4):
        end = sensor[:, :2] + directions[:, :2] * np.minimum(distance, 50.0)[:, None]
        distance = (sensor[:, 2] - world.ground_m(end)) / slope
    distance = np.where(falling & (distance > 0), distance, np.inf)
    end = sensor[:, :2] + directions[:, :2] * np.minimum(distance, 50.0)[:, None]
    step = 0.05
    here = world.ground_m(end)
    gradient = np.column_stack(
        [(world.ground_m(end + shift) - here) / step for shift in ([step, 0.0], [0.0, step])]
    )
    normals = np.column_stack([-gradient, np.ones(len(gradient))])
    return distance, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _trace_cylinder(shape: Array, sensor: Array, directions: Array) -> tuple[Array, Array]:
    x, y, radius, height = shape[:4]
    offset = sensor[:, :2] - np.array([x, y])
    flat = directions[:, :2]
    a = np.maximum(np.einsum("ni,ni->n", flat, flat), 1e-12)
    b = np.einsum("ni,ni->n", offset, flat)
    c = np.einsum("ni,ni->n", offset, offset) - radius**2
    root = b * b - a * c
    distance = (-b - np.sqrt(np.maximum(root, 0.0))) / a
    top = sensor[:, 2] + directions[:, 2] * distance
    hit = (root > 0) & (distance > 0) & (top < height)
    normal = np.column_stack([(offset + flat * distance[:, None]) / radius, np.zeros(len(offset))])
    return np.where(hit, distance, np.inf), normal


def _trace_box(shape: Array, sensor: Array, directions: Array) -> tuple[Array, Array]:
    low, high = np.array([shape[0], shape[2]]), np.array([shape[1], shape[3]])
    flat = np.where(np.abs(directions[:, :2]) < 1e-12, 1e-12, directions[:, :2])
    to_low, to_high = (low - sensor[:, :2]) / flat, (high - sensor[:, :2]) / flat
    entry, leave = np.minimum(to_low, to_high), np.maximum(to_low, to_high)
    axis = entry.argmax(axis=1)
    distance = entry.max(axis=1)
    top = sensor[:, 2] + directions[:, 2] * distance
    hit = (distance > 0) & (distance < leave.min(axis=1)) & (top < shape[4])
    normal = np.zeros((len(sensor), 3))
    normal[np.arange(len(sensor)), axis] = 1.0
    return np.where(hit, distance, np.inf), normal
