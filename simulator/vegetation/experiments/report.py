"""Markdown tables and figures of the experiments."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.terrain_grid import FREE, OCCUPIED, TerrainGrid

GREEN, BLUE, GREY = "#3a9a4b", "#4a72b0", "#444444"
MATERIAL_COLOURS = {
    Material.ASPHALT: "#8f949c",
    Material.LIGHT_TILES: "#d4cfc4",
    Material.LAWN: "#a8cf9a",
    Material.GRAVEL: "#b89c6d",
    Material.FOLIAGE: "#4c7a3f",
    Material.BARK: "#6b4a2f",
    Material.PLASTER: "#c98f7a",
}


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [list(heads), ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def percent(share: float, digits: int = 2) -> str:
    """`99.12 %`."""
    return f"{100 * share:.{digits}f} %"


def figure(width: int, height: int, columns: int = 1) -> tuple[Figure, Any]:
    """A figure [inches] with axes in a row, without a display."""
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), layout="constrained")
    return made, made.subplots(1, columns)


def save(made: Figure, path: Path) -> None:
    """Writes a figure as PNG."""
    made.savefig(path, dpi=110)


def draw_material(axes: Any, material: Any, resolution_m: float) -> None:
    """The ground of a world, in metres."""
    colours = np.array([_rgb(MATERIAL_COLOURS[kind]) for kind in Material])
    rows, columns = material.shape
    extent = (0, columns * resolution_m, 0, rows * resolution_m)
    axes.imshow(colours[material], origin="lower", extent=extent, interpolation="nearest")


def draw_grid(axes: Any, grid: TerrainGrid) -> None:
    """What a robot knows: vegetation green, other ground blue, obstacles dark, unknown clear."""
    image = np.zeros((*grid.cells.shape, 4))
    image[grid.cells == FREE] = (*_rgb(BLUE), 1.0)
    image[(grid.cells == FREE) & grid.is_vegetation()] = (*_rgb(GREEN), 1.0)
    image[grid.cells == OCCUPIED] = (*_rgb(GREY), 1.0)
    rows, columns = grid.cells.shape
    x, y = grid.origin_m
    extent = (x, x + columns * grid.resolution_m, y, y + rows * grid.resolution_m)
    axes.imshow(image, origin="lower", extent=extent, interpolation="nearest")


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return (red, green, blue)
