"""Writes a map as ROS map_server files (YAML + PGM) and its targets and blockades as TOML."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.floor_plan import FREE, OCCUPIED, FloorPlan
from scenarios.maps.placement import Placement
from scenarios.maps.terrain import terrain_cells

GREY = {FREE: 254, OCCUPIED: 0}
"""map_server's grey values; unknown is 205, just above its free threshold of 0.196"""


def pgm(cells: NDArray[np.int8]) -> bytes:
    """A binary PGM image of a grid whose row 0 is the lowest; an image's first row is its top."""
    image = np.full(cells.shape, 205, np.uint8)
    for value, grey in GREY.items():
        image[cells == value] = grey
    return _image(image)


def map_yaml(image: str, resolution_m: float, origin_m: tuple[float, float] = (0.0, 0.0)) -> str:
    """The text of a map_server YAML file."""
    return (
        f"image: {image}\n"
        f"resolution: {resolution_m}\n"
        f"origin: [{origin_m[0]}, {origin_m[1]}, 0.0]\n"
        "negate: 0\n"
        "occupied_thresh: 0.65\n"
        "free_thresh: 0.196\n"
    )


def annotations_toml(placement: Placement) -> str:
    """The text of an annotations file."""
    lines = [
        "# Mission targets and blockades; positions in the map frame [m], times [s].",
        "# Share of the targets that no robot reaches before something has been cleared:",
        f"sealed_fraction = {placement.sealed_fraction}",
    ]
    for target in placement.targets:
        x, y = target.position_m
        lines += ["", "[[targets]]", f'id = "{target.id}"', f"position_m = [{x}, {y}]"]
    for blockade in placement.blockades:
        (x0, y0), (x1, y1) = blockade.segment_m
        lines += [
            "",
            "[[blockades]]",
            f'id = "{blockade.id}"',
            f"segment_m = [[{x0}, {y0}], [{x1}, {y1}]]",
            f"clear_duration_s = {blockade.clear_duration_s}",
        ]
    return "\n".join(lines) + "\n"


def write_map(
    folder: Path,
    name: str,
    cells: NDArray[np.int8],
    resolution_m: float,
    origin_m: tuple[float, float] = (0.0, 0.0),
) -> Path:
    """Writes `name.pgm` and `name.yaml` into a folder and returns the path of the YAML file."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.pgm").write_bytes(pgm(cells))
    (folder / f"{name}.yaml").write_text(
        map_yaml(f"{name}.pgm", resolution_m, origin_m), encoding="utf-8"
    )
    return folder / f"{name}.yaml"


def write_plan(folder: Path, name: str, plan: FloorPlan) -> Path:
    """Writes the map of a floor plan, with `name_terrain.pgm` where its terrain has classes.

    Returns the path of the YAML file, which then names the classes as well.
    """
    path = write_map(folder, name, plan.cells(), plan.resolution_m)
    terrain = terrain_cells(plan)
    if terrain is not None:
        write_terrain(path, terrain, plan.terrain_classes)
    return path


def write_terrain(path: Path, terrain: NDArray[np.uint8], classes: Sequence[str]) -> None:
    """Writes `name_terrain.pgm` beside a map's YAML file, which then names its classes as well."""
    image = f"{path.stem}_terrain.pgm"
    (path.parent / image).write_bytes(_image(terrain))
    with path.open("a", encoding="utf-8") as file:
        file.write(f"terrain_image: {image}\nterrain_classes: [{', '.join(classes)}]\n")


def write_annotations(folder: Path, name: str, placement: Placement) -> Path:
    """Writes `name.toml` into a folder and returns its path."""
    path = folder / f"{name}.toml"
    path.write_text(annotations_toml(placement), encoding="utf-8")
    return path


def _image(grey: NDArray[np.uint8]) -> bytes:
    """A binary PGM of rows from the bottom."""
    height, width = grey.shape
    return f"P5\n{width} {height}\n255\n".encode() + np.ascontiguousarray(grey[::-1]).tobytes()
