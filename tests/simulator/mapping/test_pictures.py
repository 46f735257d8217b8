import numpy as np
import pytest

from simulator.mapping.octree import OctreeMap
from simulator.mapping.pictures import (
    BACKDROP,
    UNKNOWN,
    View,
    height_colours,
    isometric_picture,
    occupied_bounds,
    slice_picture,
)


@pytest.fixture(scope="module")
def block() -> OctreeMap:
    """A solid block of 10 x 10 x 4 voxels, and a free voxel beside it."""
    octree = OctreeMap(0.1)
    x, y, z = np.meshgrid(np.arange(10), np.arange(10), np.arange(4), indexing="ij")
    centres = 0.1 * (np.stack([x, y, z], axis=-1).reshape(-1, 3) + 0.5)
    octree.set_log_odds(centres, np.full(len(centres), 3.5))
    octree.set_log_odds([[1.25, 0.05, 0.05]], [-2.0])
    return octree


def test_a_slice_shows_occupied_free_and_unknown(block: OctreeMap) -> None:
    pixels = np.asarray(slice_picture(block, 0.0, 0.4, scale=2))
    assert pixels.shape == (20, 26, 3)
    assert (pixels[-2:, :20] < 20).all()  # the lowest row is at the bottom
    assert (pixels[-1, 24:] > 220).all()
    assert (pixels[0, 24:] == UNKNOWN).all()


def test_seen_from_straight_above_a_block_is_a_square_of_one_colour(block: OctreeMap) -> None:
    view = View(azimuth_rad=-np.pi / 2, elevation_rad=np.pi / 2 - 1e-3, width_px=50)
    pixels = np.asarray(isometric_picture(block, view))
    assert abs(pixels.shape[0] - 50) <= 1
    inner = pixels[2:-2, 2:-2].reshape(-1, 3)
    assert len(np.unique(inner, axis=0)) == 1


def test_three_faces_have_three_shades_and_the_rest_is_backdrop(block: OctreeMap) -> None:
    pixels = np.asarray(isometric_picture(block, View(width_px=200)))
    drawn = (pixels != BACKDROP).any(axis=2)
    assert not drawn[0, 0]
    assert not drawn[-1, -1]
    # The silhouette of a box in parallel projection has the area of its three visible faces.
    azimuth, elevation = View().azimuth_rad, View().elevation_rad
    towards = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    area_m2 = np.abs(towards) @ [1.0 * 0.4, 1.0 * 0.4, 1.0 * 1.0]
    right = np.array([-np.sin(azimuth), np.cos(azimuth)])
    pixel_m = np.abs(right).sum() / 200
    assert drawn.sum() * pixel_m**2 == pytest.approx(area_m2, rel=0.02)


def test_a_part_of_a_map_can_be_drawn_without_its_ceiling(block: OctreeMap) -> None:
    bounds = occupied_bounds(block)
    assert bounds is not None
    low, high = bounds
    assert high == pytest.approx([1.0, 1.0, 0.4])
    cut = isometric_picture(block, View(width_px=100), (low, np.array([1.0, 1.0, 0.2])))
    whole = isometric_picture(block, View(width_px=100), bounds)
    assert cut.height < whole.height
    assert occupied_bounds(OctreeMap(0.1)) is None
    assert isometric_picture(OctreeMap(0.1), View(width_px=20)).size == (20, 20)


def test_colours_run_from_the_lowest_to_the_highest() -> None:
    colours = height_colours(np.array([0.0, 1.0, 2.0]))
    assert colours[0].tolist() == [68, 1, 84]
    assert colours[-1].tolist() == [253, 231, 37]
    assert height_colours(np.empty(0)).shape == (0, 3)
