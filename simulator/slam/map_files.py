"""Occupancy grids as ROS map_server files: YAML and a PGM image, the first row at the top."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from simulator.occupancy_grid import OccupancyGrid


def write_map_server(grid: OccupancyGrid, path: Path) -> None:
    """Writes `path` (.yaml) and an image of the same name; occupied black, free white."""
    shades = np.full(grid.cells.shape, 205, dtype=np.uint8)
    shades[(grid.cells >= 0) & (grid.cells < 50)] = 254
    shades[grid.cells >= 50] = 0
    image = path.with_suffix(".pgm")
    Image.fromarray(shades[::-1]).save(image)
    x, y = grid.origin_m
    path.write_text(
        f"image: {image.name}\nresolution: {grid.resolution_m}\norigin: [{x}, {y}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        encoding="utf-8",
    )
