from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from simulator.occupancy_grid import MapError, read_map_server
from tests.simulator.floors import TWO_ROOMS, write_floor


def test_the_image_is_turned_so_that_row_0_is_the_lowest(tmp_path: Path) -> None:
    grid = read_map_server(write_floor(tmp_path, "##\n.#", resolution_m=0.5))
    assert grid.cells.shape == (4, 4)
    assert grid.cells[0].tolist() == [0, 0, 100, 100]
    assert grid.cells[3].tolist() == [100, 100, 100, 100]


def test_terrain_is_a_second_image_of_class_indices(tmp_path: Path) -> None:
    path = write_floor(tmp_path, "...\n...", resolution_m=1.0)
    Image.fromarray(np.array([[0, 1, 1], [0, 0, 0]], dtype=np.uint8)).save(tmp_path / "terrain.pgm")
    with path.open("a") as file:
        file.write("terrain_image: terrain.pgm\nterrain_classes: [default, rough]\n")
    grid = read_map_server(path)
    assert grid.forbidden(("default",)).tolist() == [[False] * 3, [False, True, True]]
    assert not grid.forbidden(("default", "rough")).any()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("resolution: 0.1\n", "", "the key 'resolution' is missing"),
        ("resolution: 0.1", "resolution: -1", "resolution must be positive"),
        ("[0.0, 0.0, 0.0]", "[0.0, 0.0, 0.5]", "turned maps are not supported"),
        ("floor.pgm", "lost.pgm", "cannot be read as an image"),
    ],
)
def test_a_broken_map_says_what_and_where(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = write_floor(tmp_path, TWO_ROOMS)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(MapError, match=message):
        read_map_server(path)
