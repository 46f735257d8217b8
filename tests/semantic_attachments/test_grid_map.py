"""Grid maps: frame, immutability, the encoding of the fleet protocol."""

import copy
import pickle

import numpy as np
import pytest

from semantic_attachments.grid_map import GridMap


def test_cells_and_positions_are_inverse() -> None:
    grid = GridMap(np.zeros((30, 20), np.int8), resolution_m=0.25, origin_m=(-2.0, 5.0))
    cells = np.arange(30 * 20)
    centres_m = grid.centres_m(cells)
    assert [grid.cell_at((x, y)) for x, y in centres_m] == cells.tolist()
    assert tuple(centres_m[0]) == (-1.875, 5.125)
    assert grid.cell_at((-2.01, 6.0)) is None
    assert grid.cell_at((3.0, 6.0)) is None


def test_it_cannot_be_written_and_does_not_see_later_changes() -> None:
    cells = np.zeros((3, 4), np.int8)
    grid = GridMap(cells, resolution_m=1.0)
    cells[0, 0] = 100
    assert grid.cells[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        grid.cells[0, 0] = 100
    assert not pickle.loads(pickle.dumps(grid)).cells.flags.writeable


def test_json_of_the_fleet_protocol_round_trips() -> None:
    rng = np.random.default_rng(3)
    grid = GridMap(
        rng.integers(-1, 101, (7, 5), dtype=np.int8),
        resolution_m=0.05,
        origin_m=(1.5, -2.5),
        terrain=rng.integers(0, 2, (7, 5), dtype=np.uint8),
        terrain_classes=("floor", "stairs"),
    )
    again = GridMap.from_json(grid.to_json())
    assert again == grid
    assert hash(again) == hash(grid)
    assert copy.deepcopy(grid) == grid
    assert GridMap(grid.cells, 0.05, (1.5, -2.5)) != grid


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cells": "AAAA"}, "cells is not"),
        ({"width": 6}, "width \\* height"),
        ({"width": 4}, "width \\* height"),
        ({"encoding": "png"}, "encoding"),
        ({"resolution_m": 0.0}, "resolution_m"),
    ],
)
def test_a_wrong_document_is_refused(change: dict[str, object], message: str) -> None:
    document = GridMap(np.zeros((7, 5), np.int8), 0.05).to_json() | change
    with pytest.raises(ValueError, match=message):
        GridMap.from_json(document)


def test_cells_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="occupancy"):
        GridMap(np.full((2, 2), 101, np.int8), 1.0)
    with pytest.raises(ValueError, match="do not fit"):
        GridMap(np.full((2, 2), 205, np.uint8), 1.0)
    with pytest.raises(ValueError, match="names class 3"):
        GridMap(np.zeros((2, 2), np.int8), 1.0, terrain=np.full((2, 2), 3, np.uint8))


def test_cells_near_a_segment_are_those_within_the_distance() -> None:
    grid = GridMap(np.zeros((40, 50), np.int8), resolution_m=0.1, origin_m=(-1.0, 2.0))
    rng = np.random.default_rng(5)
    for _ in range(20):
        a, b = rng.uniform((-1.5, 1.5), (4.5, 6.5), (2, 2))
        distance_m = rng.uniform(0.05, 0.6)
        shares = np.linspace(0, 1, 301)[:, None]
        line = a + shares * (b - a)
        centres_m = grid.centres_m(np.arange(2000))
        gaps = np.array([np.linalg.norm(line - centre, axis=1).min() for centre in centres_m])
        found = grid.cells_near_segment((tuple(a), tuple(b)), distance_m)
        certain = np.flatnonzero(gaps <= distance_m - 0.02)
        possible = np.flatnonzero(gaps <= distance_m + 0.02)
        assert set(certain) <= set(found.tolist()) <= set(possible)
