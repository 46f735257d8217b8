import base64
import zlib

import numpy as np
import pytest

from simulator.vegetation.publication import map_patches, mission_map, terrain_segments
from simulator.vegetation.terrain_grid import TerrainGrid


def grid(chance: np.ndarray, cells: np.ndarray | None = None) -> TerrainGrid:
    known = np.where(np.isnan(chance), -1, 0).astype(np.int8)
    return TerrainGrid(known if cells is None else cells, chance, 0.5, (1.0, 2.0))


def unpacked(text: str, shape: tuple[int, int], kind: type) -> np.ndarray:
    return np.frombuffer(zlib.decompress(base64.b64decode(text)), kind).reshape(shape)


def test_a_mission_gets_cells_and_classes() -> None:
    chance = np.array([[0.1, 0.9, np.nan], [0.2, 0.4, 0.6]])
    message = mission_map(grid(chance))
    assert (message["width"], message["height"]) == (3, 2)
    assert message["terrain_classes"] == ["paved", "vegetation", "verge"]
    assert unpacked(message["cells"], (2, 3), np.int8).tolist() == [[0, 0, -1], [0, 0, 0]]
    assert unpacked(message["terrain"], (2, 3), np.uint8).tolist() == [[0, 1, 0], [0, 0, 1]]


def test_patches_hold_the_news_and_nothing_else() -> None:
    before = np.full((100, 150), np.nan)
    before[10:20, 10:20] = 0.1
    after = before.copy()
    after[12:15, 18:24] = 0.9
    after[80, 140] = 0.2
    assert map_patches(grid(before), grid(before)) == []
    first, second = map_patches(grid(after), grid(before))
    assert [first[key] for key in ("row", "column", "width", "height")] == [12, 18, 6, 3]
    assert unpacked(first["terrain"], (3, 6), np.uint8).all()
    assert [second[key] for key in ("row", "column", "width", "height")] == [80, 140, 1, 1]
    assert unpacked(second["cells"], (1, 1), np.int8).tolist() == [[0]]


def test_all_that_is_known_is_news_at_first() -> None:
    chance = np.full((70, 70), 0.9)
    total = sum(patch["width"] * patch["height"] for patch in map_patches(grid(chance)))
    assert total == 70 * 70


def test_grids_of_different_places_are_refused() -> None:
    with pytest.raises(ValueError, match="same place"):
        map_patches(grid(np.full((5, 5), 0.1)), grid(np.full((4, 5), 0.1)))


def test_segments_are_connected_pieces_of_one_class() -> None:
    chance = np.full((10, 12), 0.1)
    chance[:, 5] = 0.9
    chance[0, 0] = 0.9
    chance[3, 8] = np.nan
    labels, classes = terrain_segments(grid(chance))
    assert classes == ["paved", "paved", "vegetation"]
    assert labels[0, 0] == 0
    assert labels[3, 8] == 0
    assert len(np.unique(labels[:, :5])) == 2
    assert (labels[:, 5] == 3).all()
