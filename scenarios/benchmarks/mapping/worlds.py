"""Scans to map: the real tilt scan, the real building 079, and simulated worlds of three sizes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simulator.mapping.octree import OctreeMap, RayEnd
from simulator.mapping.point_cloud import read_points
from simulator.mapping.scene import Box, Cup, Scene, Solid

DATA = Path(__file__).parents[3] / ".." / "shared" / "data"
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scan:
    """Beams from a place to their end points, map frame."""

    origin_m: Array
    points_m: NDArray[np.float32]


@dataclass(frozen=True)
class World:
    """Somewhere to map."""

    name: str
    extent_m: str
    scans: list[Scan]


def sphere_of_beams(count: int, lowest_rad: float = -1.1, highest_rad: float = 0.9) -> Array:
    """Unit directions `(n, 3)` of a pan-tilt scanner, as many a row as two rows' angle asks for."""
    rows = max(2, int(np.sqrt(count * (highest_rad - lowest_rad) / (2 * np.pi))))
    azimuth, elevation = np.meshgrid(
        np.linspace(-np.pi, np.pi, count // rows, endpoint=False),
        np.linspace(lowest_rad, highest_rad, rows),
    )
    across = np.cos(elevation)
    beams = np.stack(
        [across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)], axis=-1
    )
    return np.asarray(beams.reshape(-1, 3))


def _scans_of(
    scene: Scene, places_m: Array, beams: int, range_m: float, seed: int
) -> Iterator[Scan]:
    random = np.random.default_rng(seed)
    directions = sphere_of_beams(beams)
    for origin in places_m:
        distances, _ = scene.hits(origin, directions)
        seen = distances <= range_m
        noisy = distances[seen] + random.normal(0.0, 0.01, int(seen.sum()))
        points = origin + directions[seen] * noisy[:, None]
        yield Scan(origin, points.astype(np.float32))


def tilt_scan() -> World | None:
    """The real scan of a corridor, 88,206 points; None where the file is not there."""
    path = DATA / "octomap" / "scan.dat.bz2"
    if not path.is_file():
        return None
    return World("real tilt scan", "1 scan", [Scan(np.zeros(3), read_points(path))])


def building_079(beams: int = 89_000, scans: int = 66) -> World | None:
    """Freiburg building 079 as it was mapped, scanned anew by casting beams into its octree.

    The sensor goes up and down the corridor three times, as the thesis's robot did.
    """
    path = DATA / "octomap" / "geb079.bt"
    if not path.is_file():
        return None
    building = OctreeMap.read(path)
    along = np.concatenate(
        [
            np.linspace(-7, 29, scans // 3),
            np.linspace(29, -7, scans // 3),
            np.linspace(-6.5, 28.5, scans - 2 * (scans // 3)),
        ]
    )
    places = np.stack([along, 0.15 * np.sin(along), np.full(len(along), 0.3)], axis=1)
    directions = sphere_of_beams(beams)
    random = np.random.default_rng(79)
    found = []
    for origin in places:
        ends, centres = building.cast_rays(origin, directions, 30.0, through_unknown=True)
        hit = ends == RayEnd.HIT
        ahead, half = directions[hit], building.resolution_m / 2
        with np.errstate(divide="ignore"):
            near = np.minimum(
                (centres[hit] - half - origin) / ahead, (centres[hit] + half - origin) / ahead
            ).max(axis=1)
        near += random.uniform(0.0, 1.5 * half, len(near))  # the wall lies inside its voxel
        found.append(Scan(origin, (origin + ahead * near[:, None]).astype(np.float32)))
    return World("building 079", "39 x 15 x 3 m", found)


def corridor(beams: int = 89_000, scans: int = 66) -> World:
    """An office corridor of 43.8 x 18.2 x 3.3 m with furnished rooms, walked three times."""
    random = np.random.default_rng(5)
    wall = 0.1
    solids: list[Solid] = [
        Box((21.9, 9.1, -0.05), (44.0, 18.4, 0.1)),
        Box((21.9, 9.1, 3.35), (44.0, 18.4, 0.1)),
        *(Box((21.9, y, 1.65), (43.8, wall, 3.3)) for y in (0.0, 18.2)),
        *(Box((x, 9.1, 1.65), (wall, 18.2, 3.3)) for x in (0.0, 43.8)),
    ]
    for x in np.arange(0.0, 43.8, 7.3):
        for y, depth in ((3.9, 7.8), (14.3, 7.8)):
            border = 7.8 if y < 9 else 10.4
            door = float(x + random.uniform(1.5, 5.0))
            solids += [
                Box(((x + door) / 2, border, 1.65), (door - x, wall, 3.3)),
                Box(((door + 1.0 + x + 7.3) / 2, border, 1.65), (x + 7.3 - door - 1.0, wall, 3.3)),
                Box((x + 7.3, y, 1.65), (wall, depth, 3.3)),
            ]
            for _ in range(4):
                size = random.uniform((0.4, 0.4, 0.5), (1.6, 0.9, 1.9))
                at = (float(x + random.uniform(1, 6.3)), float(y + random.uniform(-2.6, 2.6)))
                solids.append(
                    Box((*at, size[2] / 2), tuple(size.tolist()), float(random.uniform(0, 3)))
                )
    ways = [np.linspace(1, 42.8, scans // 3), np.linspace(42.8, 1, scans // 3)]
    along = np.concatenate([*ways, np.linspace(1.5, 42.3, scans - 2 * (scans // 3))])
    places = np.stack([along, 9.1 + 0.5 * np.sin(along), np.full(len(along), 0.9)], axis=1)
    scene = Scene(tuple(solids))
    return World(
        "simulated corridor", "43.8 x 18.2 x 3.3 m", list(_scans_of(scene, places, beams, 30.0, 6))
    )


def campus(beams: int = 100_000, scans: int = 81) -> World:
    """A campus of 292 x 167 m: buildings of up to 24 m, trees, lawns, roads."""
    random = np.random.default_rng(11)
    solids: list[Solid] = [Box((146.0, 83.5, -0.5), (292.0, 167.0, 1.0))]
    blocks = [(x, y) for x in (40, 105, 170, 240) for y in (35, 85, 135)]
    for x, y in blocks:
        w, d, h = random.uniform((18, 12, 8), (38, 26, 24))
        solids.append(Box((x, y, h / 2), (w, d, h), float(random.uniform(-0.1, 0.1))))
    while len(solids) < 160:
        x, y = random.uniform((3, 3), (289, 164))
        if all(abs(x - bx) > 22 or abs(y - by) > 16 for bx, by in blocks):
            trunk = random.uniform(1.5, 3.0)
            crown = random.uniform(2.0, 5.0)
            solids.append(Cup((x, y, 0.0), 0.2, trunk + 0.5, closed=True))
            solids.append(Cup((x, y, trunk), crown / 2, crown, closed=True))
    rows = [np.linspace(8, 284, scans // 3)] * 3
    places = np.concatenate(
        [
            np.stack([row, np.full(len(row), y) + 2 * np.sin(row), np.full(len(row), 1.2)], axis=1)
            for row, y in zip(rows, (12.0, 60.0, 110.0), strict=True)
        ]
    )
    scene = Scene(tuple(solids))
    return World(
        "simulated campus", "292 x 167 x 24 m", list(_scans_of(scene, places, beams, 80.0, 12))
    )


def small_room(beams: int = 89_000, scans: int = 11) -> World:
    """A test room of 3.5 x 5.2 x 1.7 m with a staircase, as for humanoid robots."""
    solids: list[Solid] = [
        Box((1.75, 2.6, -0.05), (3.7, 5.4, 0.1)),
        *(Box((x, 2.6, 0.85), (0.05, 5.2, 1.7)) for x in (0.0, 3.5)),
        *(Box((1.75, y, 0.85), (3.5, 0.05, 1.7)) for y in (0.0, 5.2)),
        *(
            Box((0.6, 3.0 + 0.2 * step, 0.07 * (step + 1)), (0.9, 0.2, 0.14 * (step + 1)))
            for step in range(6)
        ),
        Box((2.5, 4.2, 0.42), (1.6, 1.4, 0.84)),
        Box((2.6, 1.2, 0.2), (0.5, 0.3, 0.4), 0.4),
    ]
    random = np.random.default_rng(2)
    places = np.column_stack(
        [random.uniform(0.8, 2.8, scans), random.uniform(0.8, 2.2, scans), np.full(scans, 0.6)]
    )
    scene = Scene(tuple(solids))
    return World(
        "simulated small room", "3.5 x 5.2 x 1.7 m", list(_scans_of(scene, places, beams, 10.0, 3))
    )
