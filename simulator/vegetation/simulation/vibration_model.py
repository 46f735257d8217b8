"""Vertical acceleration of a small four-wheeled robot on different ground, at different speeds.

Each wheel runs over its own profile. The displacement spectrum of the ground is that of ISO 8608,
Gd(n) = Gd(n0) (n / n0)^-2 with n0 = 0.1 cycles/m, whose classes give Gd(n0) in 1e-6 m^3: A 16,
B 64, C 256, D 1024. Asphalt is taken between A and B, tiles with joints between B and C, lawn and
overgrown gravel as D. With an exponent of 2, the spectrum of the acceleration at speed v is
Ga(f) = (2 pi)^4 Gd(n0) n0^2 f^2 v: its shape does not depend on v, its amplitude is proportional
to sqrt(v).
The body is a mass on its tyres; the resonances, dampings and the tyre's smoothing are chosen for a
vehicle like the Pioneer 2 AT, softer and more damped on turf. Sensor noise is the XSens MTi's
(0.002 m/s^2/sqrt(Hz), data sheet), and skid steering adds vibration while turning (section 6.4.1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.terrain_world import TerrainWorld
from simulator.vegetation.vibration import VibrationRun

Array = NDArray[np.float64]
RATE_HZ = 100.0
WHEELS_M = ((0.17, 0.2), (0.17, -0.2), (-0.17, 0.2), (-0.17, -0.2))
"""Contact points of the wheels in the robot's frame."""
_N0 = 0.1


@dataclass(frozen=True, slots=True)
class Ground:
    """How a wheel feels a material."""

    roughness_m3: float
    """Gd(n0) of ISO 8608."""
    resonance_hz: float
    damping: float


GROUNDS: dict[Material, Ground] = {
    Material.ASPHALT: Ground(32e-6, 9.0, 0.15),
    Material.LIGHT_TILES: Ground(128e-6, 9.0, 0.15),
    Material.LAWN: Ground(1024e-6, 5.0, 0.45),
    Material.GRAVEL: Ground(1024e-6, 7.0, 0.3),
}
SMOOTHING_HZ = 12.0
"""The tyre's contact patch evens out what is shorter than itself."""
SENSOR_NOISE = 0.002
SKID_M_S2 = 0.3
"""Added while turning on the spot at 1 rad/s."""
DRIVE_M_S2 = 0.05
"""Of motors and gears at 1 m/s."""


@dataclass(frozen=True)
class Drive:
    """Where a robot was and what it felt; `(n,)` samples at `RATE_HZ`."""

    time_s: Array
    poses: Array
    """`(n, 3)`: x, y [m] and heading [rad] in the map frame."""
    vibration: VibrationRun


def drive_along(
    world: TerrainWorld,
    points_m: Array,
    random: np.random.Generator,
    speed_m_s: tuple[float, float] = (0.3, 1.0),
    speed_change_m: float = 6.0,
) -> Drive:
    """Drives along a polyline `(k, 2)`, with a new speed every few metres."""
    poses, forward, rotation = _trajectory(points_m, random, speed_m_s, speed_change_m)
    acceleration = _acceleration(world, poses, forward, rotation, random)
    time_s = np.arange(len(poses)) / RATE_HZ
    return Drive(time_s, poses, VibrationRun(RATE_HZ, acceleration, forward, rotation))


def _trajectory(
    points_m: Array,
    random: np.random.Generator,
    speed_m_s: tuple[float, float],
    speed_change_m: float,
) -> tuple[Array, Array, Array]:
    steps = np.linalg.norm(np.diff(points_m, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    speeds = random.uniform(*speed_m_s, int(along[-1] / speed_change_m) + 2)
    distances, at = [0.0], 0.0
    while at < along[-1]:
        at += speeds[int(at / speed_change_m)] / RATE_HZ
        distances.append(at)
    s = np.minimum(np.array(distances), along[-1])
    x, y = (np.interp(s, along, points_m[:, axis]) for axis in (0, 1))
    # The heading turns within half a metre around a corner.
    ahead, behind = np.minimum(s + 0.25, along[-1]), np.maximum(s - 0.25, 0.0)
    dx, dy = (
        np.interp(ahead, along, points_m[:, axis]) - np.interp(behind, along, points_m[:, axis])
        for axis in (0, 1)
    )
    heading = np.unwrap(np.arctan2(dy, dx))
    forward = np.gradient(s) * RATE_HZ
    rotation = np.gradient(heading) * RATE_HZ
    return np.column_stack([x, y, heading]), forward, rotation


def _acceleration(
    world: TerrainWorld, poses: Array, forward: Array, rotation: Array, random: np.random.Generator
) -> Array:
    count = len(poses)
    total = np.zeros(count)
    cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    for ahead, left in WHEELS_M:
        wheel = poses[:, :2] + np.column_stack(
            [ahead * cosine - left * sine, ahead * sine + left * cosine]
        )
        material = world.material_at(wheel)
        for kind in np.unique(material):
            ground = GROUNDS[Material(kind)]
            felt = _shaped_noise(count, ground, random)
            total += np.where(material == kind, felt, 0.0) / len(WHEELS_M)
    total *= np.sqrt(np.abs(forward))
    total += random.normal(0.0, 1.0, count) * SENSOR_NOISE * np.sqrt(RATE_HZ / 2)
    shaking = DRIVE_M_S2 * np.abs(forward) + SKID_M_S2 * np.abs(rotation)
    return np.asarray(total + random.normal(0.0, 1.0, count) * shaking)


def _shaped_noise(count: int, ground: Ground, random: np.random.Generator) -> Array:
    """Acceleration `(count,)` under one wheel at 1 m/s."""
    frequency = np.fft.rfftfreq(count, 1 / RATE_HZ)
    ratio = frequency / ground.resonance_hz
    spring = 1 + (2 * ground.damping * ratio) ** 2
    body = spring / ((1 - ratio**2) ** 2 + (2 * ground.damping * ratio) ** 2)
    smoothing = 1 / (1 + (frequency / SMOOTHING_HZ) ** 4)
    density = (2 * np.pi) ** 4 * ground.roughness_m3 * _N0**2 * frequency**2 * body * smoothing
    white = np.fft.rfft(random.normal(0.0, 1.0, count))
    # White noise of unit variance has the one-sided density 2 / rate.
    return np.asarray(np.fft.irfft(white * np.sqrt(density * RATE_HZ / 2), count))
