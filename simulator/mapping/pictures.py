"""Pictures of 3D maps, drawn without a display: slices, and isometric views by ray casting."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from simulator.mapping.octree import OctreeMap, RayEnd
from simulator.mapping.traversability import occupancy_slice
from simulator.occupancy_grid import OccupancyGrid

Array = NDArray[np.float64]

UNKNOWN, BACKDROP = (168, 190, 218), (255, 255, 255)
_HEIGHTS = np.array([(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)])
"""Colours from low to high (viridis, by Smith and van der Walt)."""
_FACES = np.array([0.62, 0.8, 1.0])
"""Brightness of faces across x, y and z."""


@dataclass(frozen=True, slots=True)
class View:
    """From where an isometric picture is taken, and how large it is."""

    azimuth_rad: float = -2.1
    """Of the viewer, seen from the map."""
    elevation_rad: float = 0.7
    width_px: int = 1200
    threads: int = 1


def grid_picture(grid: OccupancyGrid, scale: int = 1) -> Image.Image:
    """Free white, occupied black, unknown blue; north is up."""
    shade = np.rint(255 * (1 - grid.cells.astype(np.float64) / 100)).astype(np.uint8)
    pixels = np.repeat(shade[:, :, None], 3, axis=2)
    pixels[grid.cells < 0] = UNKNOWN
    picture = Image.fromarray(np.ascontiguousarray(pixels[::-1]))
    return picture.resize((picture.width * scale, picture.height * scale), Image.Resampling.NEAREST)


def slice_picture(octree: OctreeMap, low_m: float, high_m: float, scale: int = 1) -> Image.Image:
    """The most likely obstacle of each column in a height band."""
    return grid_picture(occupancy_slice(octree, low_m, high_m), scale)


def occupied_bounds(octree: OctreeMap) -> tuple[Array, Array] | None:
    """Lowest and highest corner `(3,)` [m] of the occupied voxels; None if there is none."""
    centres = octree.occupied_voxels()
    if len(centres) == 0:
        return None
    half = octree.resolution_m / 2
    return centres.min(axis=0) - half, centres.max(axis=0) + half


def isometric_picture(
    octree: OctreeMap, view: View, bounds_m: tuple[Array, Array] | None = None
) -> Image.Image:
    """Occupied voxels in parallel projection, coloured by height.

    Args:
        bounds_m: lowest and highest corner `(3,)` of the part that is shown, such as a room below
            its ceiling; all that is occupied if not given.
    """
    bounds_m = bounds_m or occupied_bounds(octree)
    if bounds_m is None:
        return Image.new("RGB", (view.width_px, view.width_px), BACKDROP)
    low, high = (np.asarray(corner, dtype=np.float64) for corner in bounds_m)
    right, up, towards = _axes(view)
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1)), axis=-1).reshape(-1, 3)
    across, above = corners @ right, corners @ up
    pixel_m = float(np.ptp(across)) / view.width_px
    rows = max(1, int(np.ceil(np.ptp(above) / pixel_m)))
    u, v = np.meshgrid(
        across.min() + (np.arange(view.width_px) + 0.5) * pixel_m,
        above.max() - (np.arange(rows) + 0.5) * pixel_m,
    )
    ahead = -towards
    starts = u.reshape(-1, 1) * right + v.reshape(-1, 1) * up
    enter, leave = _through(starts, ahead, low, high)
    meets = np.flatnonzero(enter < leave)
    pixels = np.full((rows * view.width_px, 3), BACKDROP, dtype=np.uint8)
    if len(meets):
        # A hair inside, so that a start on the border does not fall into the voxel before it.
        skin = 1e-3 * octree.resolution_m
        origins = starts[meets] + (enter[meets, None] + skin) * ahead
        ends, centres = octree.cast_rays(
            origins,
            np.broadcast_to(ahead, origins.shape),
            float((leave - enter)[meets].max()),
            through_unknown=True,
            threads=view.threads,
        )
        half = octree.resolution_m / 2
        inside = ((centres > low - half) & (centres < high + half)).all(axis=1)
        hit = (ends == RayEnd.HIT) & inside
        pixels[meets[hit]] = _shaded(
            starts[meets[hit]], ahead, centres[hit], half, (low[2], high[2])
        )
    return Image.fromarray(pixels.reshape(rows, view.width_px, 3))


def height_colours(
    heights_m: Array, low_m: float | None = None, high_m: float | None = None
) -> NDArray[np.uint8]:
    """Colours `(n, 3)` of heights `(n,)` between a lowest and a highest one."""
    if len(heights_m) == 0:
        return np.empty((0, 3), dtype=np.uint8)
    low = float(heights_m.min()) if low_m is None else low_m
    high = float(heights_m.max()) if high_m is None else high_m
    at = np.clip((heights_m - low) / max(high - low, 1e-9), 0, 1) * (len(_HEIGHTS) - 1)
    steps = np.arange(len(_HEIGHTS))
    channels = [np.interp(at, steps, _HEIGHTS[:, channel]) for channel in range(3)]
    return np.asarray(np.rint(np.stack(channels, axis=1)), dtype=np.uint8)


def _axes(view: View) -> tuple[Array, Array, Array]:
    ca, sa = np.cos(view.azimuth_rad), np.sin(view.azimuth_rad)
    ce, se = np.cos(view.elevation_rad), np.sin(view.elevation_rad)
    towards = np.array([ce * ca, ce * sa, se])
    right = np.array([-sa, ca, 0.0])
    return right, np.cross(towards, right), towards


def _through(starts: Array, ahead: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Where parallel rays enter and leave a box, as distances from their starts."""
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (low - starts) / ahead, (high - starts) / ahead
    enter = np.nanmax(np.minimum(first, second), axis=1)
    leave = np.nanmin(np.maximum(first, second), axis=1)
    return np.asarray(enter), np.asarray(leave)


def _shaded(
    starts: Array, ahead: Array, centres: Array, half: float, span_m: tuple[float, float]
) -> NDArray[np.uint8]:
    """Colour by height, brightness by the face through which a ray enters its voxel."""
    with np.errstate(divide="ignore", invalid="ignore"):
        near = np.minimum((centres - half - starts) / ahead, (centres + half - starts) / ahead)
    face = np.nan_to_num(near, nan=-np.inf).argmax(axis=1)
    colours = height_colours(centres[:, 2], *span_m)
    return np.asarray(np.rint(colours * _FACES[face, None]), dtype=np.uint8)
