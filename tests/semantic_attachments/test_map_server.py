"""Reading map_server files."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from semantic_attachments.map_server import MapFileError, read_map


def write(folder: Path, pixels: np.ndarray, extra: str = "", name: str = "map.pgm") -> Path:
    Image.fromarray(pixels).save(folder / name)
    path = folder / "map.yaml"
    path.write_text(f"image: {name}\nresolution: 0.1\norigin: [-1.0, 2.0, 0.0]\n{extra}")
    return path


def test_the_first_row_of_the_image_is_the_top_of_the_map(tmp_path: Path) -> None:
    pixels = np.array([[0, 205, 254], [254, 254, 254]], np.uint8)
    grid = read_map(write(tmp_path, pixels))
    assert grid.cells.tolist() == [[0, 0, 0], [100, -1, 0]]
    assert (grid.resolution_m, grid.origin_m) == (0.1, (-1.0, 2.0))


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ("", [100, 100, -1, -1, 0]),
        ("negate: 1\n", [0, -1, -1, 100, 100]),
        ("occupied_thresh: 0.95\nfree_thresh: 0.5\n", [100, -1, 0, 0, 0]),
        ("mode: scale\n", [100, 100, 66, 1, 0]),
        ("mode: raw\n", [0, 80, -1, -1, -1]),
    ],
)
def test_brightness_reads_as_the_fields_say(
    tmp_path: Path, fields: str, expected: list[int]
) -> None:
    # Occupied shares 1, 0.686, 0.498, 0.2, 0.004; 0.498 scaled is 99 * 0.302 / 0.454.
    pixels = np.array([[0, 80, 128, 204, 254]], np.uint8)
    assert read_map(write(tmp_path, pixels, fields)).cells.tolist() == [expected]


def test_colour_images_with_transparency(tmp_path: Path) -> None:
    pixels = np.zeros((1, 3, 4), np.uint8)
    pixels[0, :, 3] = (255, 0, 255)
    pixels[0, 2, :3] = 255
    path = write(tmp_path, pixels, "mode: scale\n", name="map.png")
    assert read_map(path).cells.tolist() == [[100, -1, 0]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("image: missing.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n", "missing.pgm does not exist"),
        ("resolution: 0.1\norigin: [0, 0, 0]\n", "field image is missing"),
        ("image: map.pgm\nresolution: wide\norigin: [0, 0, 0]\n", "not a number"),
        ("image: map.pgm\nresolution: -1\norigin: [0, 0, 0]\n", "resolution_m is -1"),
        ("image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0.5]\n", "yaw"),
        ("image: map.pgm\nresolution: 0.1\norigin: [0, 0]\nmode: x\n", "mode 'x'"),
        ("image: map.yaml\nresolution: 0.1\norigin: [0, 0]\n", "cannot be read"),
        ("- 1\n", "fields image, resolution and origin"),
        ("{\n", "not YAML"),
    ],
)
def test_a_faulty_file_is_refused_by_name(tmp_path: Path, content: str, message: str) -> None:
    path = write(tmp_path, np.zeros((2, 2), np.uint8))
    path.write_text(content)
    with pytest.raises(MapFileError, match=message) as caught:
        read_map(path)
    assert str(path) in str(caught.value)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MapFileError, match="no such map file"):
        read_map(tmp_path / "nowhere.yaml")
