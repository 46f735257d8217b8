"""A 3D scene of simple solids and a depth sensor that looks at it.

Positions are in the map frame [m], z up.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulator import _core
from simulator.mapping.oriented_box import OrientedBox

Array = NDArray[np.float64]


class Solid(Protocol):
    """Something that beams hit."""

    def distances_m(self, origin_m: Array, directions: Array) -> Array:
        """Distance along each unit direction `(n, 3)` to the surface `(n,)`; infinite where it is
        missed."""


@dataclass(frozen=True, slots=True)
class Box:
    """A box standing on a height, turned about the vertical."""

    centre_m: tuple[float, float, float]
    size_m: tuple[float, float, float]
    yaw_rad: float = 0.0

    def distances_m(self, origin_m: Array, directions: Array) -> Array:
        cosine, sine = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        axes = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        box = OrientedBox(np.array(self.centre_m), axes, np.array(self.size_m) / 2)
        enter, leave = box.clip(origin_m, origin_m + directions)
        first = np.where(enter > 1e-9, enter, leave)
        return np.where((leave >= enter) & (first > 1e-9), first, np.inf)


@dataclass(frozen=True, slots=True)
class Cup:
    """An upright cylinder, open at the top: a wall without thickness and a bottom."""

    base_m: tuple[float, float, float]
    """Centre of the bottom."""
    radius_m: float
    height_m: float
    closed: bool = False
    """With a lid: a can instead of a cup."""

    def distances_m(self, origin_m: Array, directions: Array) -> Array:
        start = origin_m - np.array(self.base_m)
        best = np.full(len(directions), np.inf)
        across = (directions[:, :2] ** 2).sum(axis=1)
        half = directions[:, :2] @ start[:2]
        root = half**2 - across * (start[:2] @ start[:2] - self.radius_m**2)
        with np.errstate(invalid="ignore", divide="ignore"):
            for sign in (-1.0, 1.0):
                wall = (-half + sign * np.sqrt(root)) / across
                z = start[2] + wall * directions[:, 2]
                hit = (wall > 1e-9) & (z >= 0) & (z <= self.height_m)
                best = np.where(hit & (wall < best), wall, best)
            for level in (0.0, self.height_m) if self.closed else (0.0,):
                disc = (level - start[2]) / directions[:, 2]
                xy = start[:2] + disc[:, None] * directions[:, :2]
                hit = (disc > 1e-9) & ((xy**2).sum(axis=1) <= self.radius_m**2)
                best = np.where(hit & (disc < best), disc, best)
        return best


@dataclass(frozen=True)
class Scene:
    """Solids, the nearest of which a beam hits."""

    solids: tuple[Solid, ...]

    def distances_m(self, origin_m: Array, directions: Array) -> Array:
        """Distance to the first surface along unit directions `(n, 3)`; infinite where nothing
        is."""
        return self.hits(origin_m, directions)[0]

    def hits(
        self, origin_m: Sequence[float] | Array, directions: Array, threads: int = 1
    ) -> tuple[Array, NDArray[np.int32]]:
        """Distance along unit directions `(n, 3)` and the index of the solid that is hit.

        Where nothing is, infinity and -1. Boxes and cups are cast natively, any other solid by its
        own `distances_m`.
        """
        x, y, z = np.asarray(origin_m, dtype=np.float64).tolist()
        beams = np.ascontiguousarray(directions, dtype=np.float64)
        native, numbers, others = self._kernel
        distances, hit = native.cast((x, y, z), beams, threads)
        solids = np.where(hit >= 0, numbers[hit], np.int32(-1))
        for number in others:
            other = self.solids[number].distances_m(np.array([x, y, z]), beams)
            solids[other < distances] = number
            distances = np.minimum(distances, other)
        return distances, solids

    @cached_property
    def _kernel(self) -> tuple[_core.Solids, NDArray[np.int32], list[int]]:
        """The native solids, their indices in `solids`, and the indices of all others."""
        boxes = [(i, s) for i, s in enumerate(self.solids) if isinstance(s, Box)]
        cups = [(i, s) for i, s in enumerate(self.solids) if isinstance(s, Cup)]
        numbers = [i for i, _ in boxes] + [i for i, _ in cups]
        native = _core.Solids(
            np.array([(*s.centre_m, *s.size_m, s.yaw_rad) for _, s in boxes]).reshape(-1, 7),
            np.array(
                [(*s.base_m, s.radius_m, s.height_m, float(s.closed)) for _, s in cups]
            ).reshape(-1, 6),
        )
        others = sorted(set(range(len(self.solids))) - set(numbers))
        return native, np.array([*numbers, -1], dtype=np.int32), others


@dataclass(frozen=True, slots=True)
class DepthSensor:
    """A depth camera."""

    horizontal_field_rad: float = 1.0
    vertical_field_rad: float = 0.8
    columns: int = 160
    rows: int = 120
    range_m: float = 5.0
    noise_m: float = 0.0
    """Standard deviation of a range at 1 m; it grows with the square of the range, as a stereo
    camera's does."""

    def directions(self, yaw_rad: float, pitch_rad: float) -> Array:
        """Unit directions `(n, 3)` in the map frame; a positive pitch looks down."""
        y = np.tan(np.linspace(-0.5, 0.5, self.columns) * self.horizontal_field_rad)
        z = np.tan(np.linspace(-0.5, 0.5, self.rows) * self.vertical_field_rad)
        grid = np.stack(
            [np.ones((self.rows, self.columns)), *np.meshgrid(y, z, indexing="xy")], axis=-1
        ).reshape(-1, 3)
        grid /= np.linalg.norm(grid, axis=1)[:, None]
        cp, sp, cy, sy = np.cos(pitch_rad), np.sin(pitch_rad), np.cos(yaw_rad), np.sin(yaw_rad)
        tilt = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
        turn = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
        turned: Array = grid @ (turn @ tilt).T
        return turned

    def measure(
        self,
        scene: Scene,
        origin_m: Sequence[float] | Array,
        yaw_rad: float,
        pitch_rad: float,
        random: np.random.Generator | None = None,
    ) -> NDArray[np.float32]:
        """End points `(n, 3)` of the beams that hit something within range, map frame."""
        origin = np.asarray(origin_m, dtype=np.float64)
        directions = self.directions(yaw_rad, pitch_rad)
        ranges = scene.distances_m(origin, directions)
        if self.noise_m > 0 and random is not None:
            seen = np.isfinite(ranges)
            ranges[seen] += random.normal(size=int(seen.sum())) * self.noise_m * ranges[seen] ** 2
        hit = (ranges > 0) & (ranges <= self.range_m)
        points: NDArray[np.float32] = (origin + directions[hit] * ranges[hit, None]).astype(
            np.float32
        )
        return points


def tabletop_scene(objects: int = 6, seed: int = 0) -> Scene:
    """A room of 6 x 6 x 2.5 m with a table of 1.2 x 0.8 x 0.75 m in its middle and objects well
    apart on it."""
    random = np.random.default_rng(seed)
    solids: list[Solid] = [
        Box((0.0, 0.0, -0.05), (6.0, 6.0, 0.1)),
        *(Box((x, 0.0, 1.25), (0.1, 6.0, 2.5)) for x in (-3.05, 3.05)),
        *(Box((0.0, y, 1.25), (6.0, 0.1, 2.5)) for y in (-3.05, 3.05)),
        Box((0.0, 0.0, 0.73), (1.2, 0.8, 0.04)),
        *(Box((x, y, 0.355), (0.05, 0.05, 0.71)) for x in (-0.55, 0.55) for y in (-0.35, 0.35)),
    ]
    places = [(x, y) for x in (-0.4, 0.0, 0.4) for y in (-0.2, 0.2)]
    for number, place in enumerate(random.permutation(len(places))[:objects].tolist()):
        x, y = (value + random.uniform(-0.04, 0.04) for value in places[place])
        size = random.uniform(0.04, 0.07)
        if number % 2 == 0:
            height = random.uniform(0.08, 0.2)
            yaw = random.uniform(0, np.pi)
            solids.append(Box((x, y, 0.75 + height / 2), (2 * size, size, height), yaw))
        else:
            solids.append(Cup((x, y, 0.75), size, random.uniform(0.08, 0.14)))
    return Scene(tuple(solids))
