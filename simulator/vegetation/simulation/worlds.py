"""Generated outdoor places: a street along a lawn, and a campus with a network of paths."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.terrain_world import TerrainWorld

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Campus:
    """A terrain world and the centre lines of its paths."""

    world: TerrainWorld
    nodes_m: Array
    """`(n, 2)`: where paths meet."""
    paths: tuple[tuple[int, int, Array], ...]
    """First and last node and centre line `(k, 2)` of each path."""

    def line(self, first: int, last: int) -> Array:
        """Centre line between two neighbouring nodes, in this direction."""
        for a, b, points in self.paths:
            if (a, b) == (first, last):
                return points
            if (b, a) == (first, last):
                return points[::-1]
        raise KeyError(f"no path joins nodes {first} and {last}")

    def tour(self, start: int = 0) -> Array:
        """A way `(k, 2)` [m] over every path, back and forth."""
        seen: set[tuple[int, int]] = set()
        points = [self.nodes_m[start][None]]
        neighbours: dict[int, list[int]] = {}
        for a, b, _ in self.paths:
            neighbours.setdefault(a, []).append(b)
            neighbours.setdefault(b, []).append(a)
        visited = {start}

        def visit(node: int) -> None:
            for other in sorted(neighbours.get(node, [])):
                edge = (min(node, other), max(node, other))
                if edge in seen:
                    continue
                seen.add(edge)
                points.append(self.line(node, other))
                if other not in visited:
                    visited.add(other)
                    visit(other)
                points.append(self.line(other, node))

        visit(start)
        return np.concatenate(points)


def street_and_lawn(seed: int, size_m: tuple[float, float] = (50.0, 24.0)) -> TerrainWorld:
    """A street with a wavy edge along a lawn, partly paved with light tiles, and a few trees."""
    random = np.random.default_rng([seed, 2])
    resolution_m = 0.05
    rows, columns = round(size_m[1] / resolution_m), round(size_m[0] / resolution_m)
    x = (np.arange(columns) + 0.5) * resolution_m
    y = (np.arange(rows) + 0.5)[:, None] * resolution_m
    edge = np.full(columns, 0.5 * size_m[1])
    for _ in range(3):
        phase = 2 * np.pi * x / random.uniform(10, 30) + random.uniform(0, 6)
        edge += random.uniform(0.2, 0.6) * np.sin(phase)
    material = np.where(y > edge, np.uint8(Material.LAWN), np.uint8(Material.ASPHALT))
    tiles = (x > 0.35 * size_m[0]) & (x < 0.55 * size_m[0]) & (y <= edge)
    material = np.where(tiles, np.uint8(Material.LIGHT_TILES), material)
    trunks = [
        [random.uniform(3, size_m[0] - 3), size_m[1] - random.uniform(1, 2), 0.2, 6, Material.BARK]
        for _ in range(4)
    ]
    return TerrainWorld(material, resolution_m, seed, cylinders=np.array(trunks, dtype=np.float64))


@dataclass(frozen=True, slots=True)
class CampusParameters:
    """What a campus looks like."""

    size_m: tuple[float, float] = (120.0, 90.0)
    spacing_m: float = 35.0
    """Between nodes of the path network."""
    path_width_m: tuple[float, float] = (3.0, 4.5)
    extra_paths: float = 0.4
    """Share of possible paths beyond a spanning tree that exist."""
    tiled: float = 0.2
    """Share of paths paved with light tiles."""
    gravel_patches: int = 3
    trees: int = 30
    resolution_m: float = 0.1


def campus(seed: int, parameters: CampusParameters | None = None) -> Campus:
    """Lawn with a network of curved paths, trees, hedges, buildings and patches of gravel."""
    parameters = parameters or CampusParameters()
    random = np.random.default_rng([seed, 3])
    width, height = parameters.size_m
    counts = [max(2, round(extent / parameters.spacing_m)) for extent in (width, height)]
    nodes = _nodes(random, counts, parameters)
    paths = _paths(random, counts, nodes, parameters)
    rows, columns = (round(extent / parameters.resolution_m) for extent in (height, width))
    material = np.full((rows, columns), np.uint8(Material.LAWN))
    away = _draw_paths(random, material, paths, parameters)
    _draw_gravel(random, material, away, parameters)
    trunks = _positions(random, away, parameters, parameters.trees, clear_m=1.0)
    cylinders = [[*spot, random.uniform(0.12, 0.3), 6.0, Material.BARK] for spot in trunks]
    boxes = []
    for x, y in _positions(random, away, parameters, 6, clear_m=7.0).tolist():
        half = random.uniform(2.0, 5.0, 2)
        boxes.append([x - half[0], x + half[0], y - half[1], y + half[1], 5.0, Material.PLASTER])
    for x, y in _positions(random, away, parameters, 6, clear_m=3.0).tolist():
        boxes.append([x - 2.0, x + 2.0, y - 0.4, y + 0.4, 1.2, Material.FOLIAGE])
    world = TerrainWorld(
        material,
        parameters.resolution_m,
        seed,
        cylinders=np.array(cylinders, dtype=np.float64).reshape(-1, 5),
        boxes=np.array(boxes, dtype=np.float64).reshape(-1, 6),
    )
    return Campus(world, nodes, tuple(paths))


def _nodes(random: np.random.Generator, counts: list[int], parameters: CampusParameters) -> Array:
    """A jittered lattice, inside the border, row by row."""
    lattice = [
        [(column + 0.5) / counts[0], (row + 0.5) / counts[1]]
        for row, column in itertools.product(range(counts[1]), range(counts[0]))
    ]
    jitter = random.uniform(-0.18, 0.18, (len(lattice), 2)) / np.array(counts)
    return np.asarray((np.array(lattice) + jitter) * np.array(parameters.size_m))


def _paths(
    random: np.random.Generator, counts: list[int], nodes: Array, parameters: CampusParameters
) -> list[tuple[int, int, Array]]:
    """Curves along a random spanning tree of the lattice and some further edges."""
    columns, rows = counts
    edges = [
        (row * columns + column, (row + dr) * columns + column + dc)
        for row, column in itertools.product(range(rows), range(columns))
        for dr, dc in ((0, 1), (1, 0))
        if row + dr < rows and column + dc < columns
    ]
    root = list(range(len(nodes)))

    def find(node: int) -> int:
        while root[node] != node:
            node = root[node]
        return node

    chosen = []
    for k in random.permutation(len(edges)):
        a, b = edges[k]
        if find(a) != find(b):
            root[find(a)] = find(b)
            chosen.append((a, b))
        elif random.random() < parameters.extra_paths:
            chosen.append((a, b))
    curves = []
    for a, b in sorted(chosen):
        start, end = nodes[a], nodes[b]
        along = end - start
        across = np.array([-along[1], along[0]])
        middle = (start + end) / 2 + across * random.uniform(-0.15, 0.15)
        t = np.linspace(0.0, 1.0, max(2, int(np.linalg.norm(along) / 0.1)))[:, None]
        curve = (1 - t) ** 2 * start + 2 * t * (1 - t) * middle + t**2 * end
        curves.append((int(a), int(b), curve))
    return curves


def _draw_paths(
    random: np.random.Generator,
    material: NDArray[np.uint8],
    paths: list[tuple[int, int, Array]],
    parameters: CampusParameters,
) -> Array:
    """Draws all paths and returns the distance of each cell from the nearest centre line [m]."""
    nearest = np.full(material.shape, np.inf, np.float32)
    resolution_m = parameters.resolution_m
    for _, _, points in paths:
        half_m = random.uniform(*parameters.path_width_m) / 2
        kind = Material.LIGHT_TILES if random.random() < parameters.tiled else Material.ASPHALT
        low = np.maximum(np.floor((points.min(axis=0) - 10) / resolution_m).astype(int), 0)
        high = np.ceil((points.max(axis=0) + 10) / resolution_m).astype(int)
        window = (slice(low[1], high[1]), slice(low[0], high[0]))
        inside = material[window]
        rows, columns = inside.shape[0], inside.shape[1]
        off_line = np.ones((rows, columns), np.bool_)
        cells = np.floor(points / resolution_m).astype(int) - low
        off_line[
            np.clip(cells[:, 1], 0, rows - 1),
            np.clip(cells[:, 0], 0, columns - 1),
        ] = False
        away = ndimage.distance_transform_edt(off_line).astype(np.float32) * resolution_m
        inside[away <= half_m] = np.uint8(kind)
        nearest[window] = np.minimum(nearest[window], away)
    return np.where(np.isfinite(nearest), nearest, 10.0).astype(np.float64)


def _draw_gravel(
    random: np.random.Generator,
    material: NDArray[np.uint8],
    away: Array,
    parameters: CampusParameters,
) -> None:
    y = (np.arange(material.shape[0], dtype=np.float32) * parameters.resolution_m)[:, None]
    x = np.arange(material.shape[1], dtype=np.float32) * parameters.resolution_m
    beside = (away > parameters.path_width_m[1] / 2) & (away < parameters.path_width_m[1] / 2 + 2)
    rows, columns = np.nonzero(beside)
    for _ in range(parameters.gravel_patches):
        k = random.integers(len(rows))
        centre = np.array([columns[k], rows[k]]) * parameters.resolution_m
        radius_m = random.uniform(1.5, 3.0)
        inside = (x - centre[0]) ** 2 + (y - centre[1]) ** 2 < radius_m**2
        material[inside & (material == Material.LAWN)] = np.uint8(Material.GRAVEL)


def _positions(
    random: np.random.Generator,
    away: Array,
    parameters: CampusParameters,
    count: int,
    clear_m: float,
) -> Array:
    """Positions `(k, 2)` on grass at least so far from any path's edge."""
    rows, columns = np.nonzero(away > parameters.path_width_m[1] / 2 + clear_m)
    if not len(rows):
        return np.zeros((0, 2))
    chosen = random.integers(len(rows), size=count)
    centres = np.column_stack([columns[chosen], rows[chosen]]) + 0.5
    return np.asarray(centres * parameters.resolution_m)
