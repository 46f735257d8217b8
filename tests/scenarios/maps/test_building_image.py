"""Drawings become grids: walls where any pixel is dark, outside unknown."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scenarios.maps.building_image import sample
from scenarios.maps.floor_plan import FREE, UNKNOWN
from scenarios.maps.free_space import component_at, components


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """20 x 10 m at 10 pixels a metre: two rooms, a door of 1.2 m and one of 0.5 m between them."""
    grey = np.full((100, 200), 255, np.uint8)
    grey[5:95, 5:195] = 0
    grey[7:93, 7:193] = 255
    grey[7:93, 99:101] = 0
    grey[20:32, 99:101] = 255
    grey[70:75, 99:101] = 255
    path = tmp_path / "drawing.png"
    Image.fromarray(grey).save(path)
    return path


def test_top_row_of_the_image_is_the_top_of_the_map(drawing: Path) -> None:
    cells = sample(drawing, (20.0, 10.0), 0.1)
    assert cells.shape == (100, 200)
    assert cells[100 - 26, 100] == FREE  # the wide door lies in the upper half
    assert cells[26, 100] == FREE or cells[27, 100] == FREE  # the narrow one in the lower


def test_outside_is_unknown(drawing: Path) -> None:
    cells = sample(drawing, (20.0, 10.0), 0.1, inside_m=(5.0, 5.0))
    assert cells[1, 1] == UNKNOWN
    assert cells[50, 50] == FREE
    assert cells[50, 150] == FREE
    with pytest.raises(ValueError, match="on a wall"):
        sample(drawing, (20.0, 10.0), 0.1, inside_m=(10.0, 5.0))


def test_coarser_cells_keep_thin_walls(drawing: Path) -> None:
    cells = sample(drawing, (20.0, 10.0), 0.5)
    labels = components(cells, 0.5, 0.0)
    assert component_at(labels, 0.5, (0.1, 0.1)) != component_at(labels, 0.5, (5.0, 5.0))
