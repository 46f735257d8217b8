"""The frozen world: immutability, blockades drawn into the map."""

import pickle
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World


def test_it_cannot_be_written(two_rooms: World) -> None:
    tables: Any = two_rooms
    with pytest.raises(TypeError):
        tables.locations["north"] = Location((0.0, 0.0))
    with pytest.raises(AttributeError):
        tables.version = 3
    with pytest.raises(AttributeError):
        tables.robots["robot"].speed_m_s = 2.0


def test_it_travels_between_processes(two_rooms: World) -> None:
    again = pickle.loads(pickle.dumps(two_rooms))
    assert again == two_rooms
    assert hash(again) == hash(two_rooms)


def test_a_location_at_an_unknown_blockade_is_refused() -> None:
    grid = GridMap(np.zeros((2, 2), np.int8), 1.0)
    with pytest.raises(ValueError, match="no known blockade"):
        World(grid, {"a": Location((0.5, 0.5), blockade="b")})


def test_no_eight_connected_path_slips_through_a_blockade() -> None:
    rng = np.random.default_rng(1)
    grid = GridMap(np.zeros((50, 50), np.int8), resolution_m=0.2)
    for _ in range(100):
        x0, x1 = rng.uniform(0, 10, 2)
        wall = Blockade("wall", ((x0, -0.1), (x1, 10.1)), 1.0)
        drawn = World(grid, blockades={"wall": wall}).cells_with_blockades()
        regions, count = ndimage.label(drawn == 0, structure=np.ones((3, 3)))
        assert np.unique(regions[:, 0]).size <= 2
        joined = set(regions[25, regions[25] > 0])
        assert count == len(joined) or count <= 2
        gap = np.flatnonzero(drawn[25] == 100)
        assert gap.size > 0
        left, right = regions[25, gap[0] - 1 : gap[0]], regions[25, gap[-1] + 1 : gap[-1] + 2]
        assert not set(left) & set(right)


def test_a_blockade_does_not_cover_walls(two_rooms: World) -> None:
    cells = two_rooms.blockades["door"].cells(two_rooms.grid)
    assert (two_rooms.grid.cells.ravel()[cells] < 65).all()
    assert (np.flatnonzero(two_rooms.cells_with_blockades() != two_rooms.grid.cells) == cells).all()


def test_faulty_models_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match="rover: speed_m_s is 0"):
        RobotModel("rover", radius_m=0.2, speed_m_s=0.0)
    with pytest.raises(ValueError, match="rover: radius_m is -1"):
        RobotModel("rover", radius_m=-1, speed_m_s=1.0)
    with pytest.raises(ValueError, match="'speed_m_s' is missing"):
        RobotModel.from_json("rover", {"radius_m": 0.3})
    with pytest.raises(ValueError, match="clear_duration_s is nan"):
        Blockade("b", ((0, 0), (1, 1)), clear_duration_s=float("nan"))


def test_a_robot_type_of_the_fleet_protocol() -> None:
    document = {"radius_m": 0.3, "speed_m_s": 1.0, "enters": ["a", "b"], "colour": "red"}
    model = RobotModel.from_json("rover", document)
    assert model == RobotModel("rover", 0.3, 1.0, enters=("a", "b"))
