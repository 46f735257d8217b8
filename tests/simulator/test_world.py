import math
from pathlib import Path

import numpy as np
import pytest

from simulator.fleet_scenario import HiddenBlockade, ScenarioError
from simulator.occupancy_grid import read_map_server
from simulator.segment_geometry import nearest_on_segment
from simulator.world import World, wall_segments
from tests.simulator.floors import TWO_ROOMS, write_floor


@pytest.fixture
def world(tmp_path: Path) -> World:
    grid = read_map_server(write_floor(tmp_path, TWO_ROOMS))
    return World(grid, (HiddenBlockade("blockade_1", ((9.5, 3.0), (9.5, 4.0)), 5.0),))


def drive_right(world: World, seconds: float) -> float:
    """Drives robot `r` with 1 m/s to the right and returns where it ends."""
    for _ in range(round(seconds / 0.05)):
        world.drive("r", (1.0, 0.0), 0.0)
        world.step(0.05)
    return world.pose("r")[0]


def test_a_body_moves_as_it_is_driven(world: World) -> None:
    world.place("r", 0.3, (2.0, 2.0, 0.0))
    assert drive_right(world, 3.0) == pytest.approx(5.0, abs=1e-6)
    assert world.contacts.wall == 0


def test_walls_stop_a_body_and_the_touch_is_counted(world: World) -> None:
    world.place("r", 0.3, (2.0, 1.6, 0.0))
    # Driven against it without pause, a body is pressed in a little; it never gets through.
    assert 8.7 <= drive_right(world, 12.0) < 9.0
    assert world.contacts.wall > 0


def test_a_blockade_stops_a_body_until_it_is_cleared(world: World) -> None:
    world.place("r", 0.3, (7.0, 3.5, 0.0))
    assert 9.1 < drive_right(world, 5.0) < 9.5
    assert world.contacts.blockade > 0
    assert world.contacts.crossings == 0
    world.clear("blockade_1")
    assert drive_right(world, 3.0) > 12.0
    assert world.blockades() == ()


def test_a_start_inside_a_wall_is_refused_with_its_place(world: World) -> None:
    with pytest.raises(ScenarioError, match=r"'r' cannot stand at \(1\.10, 2\.00\)"):
        world.place("r", 0.3, (1.1, 2.0, 0.0))
    with pytest.raises(ScenarioError, match="move its start"):
        world.place("r", 0.3, (-5.0, 2.0, 0.0))


def test_the_outline_of_a_square_is_four_segments() -> None:
    walls = np.zeros((5, 5), dtype=bool)
    walls[1:4, 1:4] = True
    inner = [s for s in wall_segments(walls, 1.0, (10.0, 0.0)) if 10 < s[0][0] < 15 or s[0][1] == 1]
    assert ((11.0, 1.0), (14.0, 1.0)) in inner
    assert ((14.0, 1.0), (14.0, 4.0)) in inner


def test_blockades_near_leaves_out_none_within_reach(tmp_path: Path) -> None:
    grid = read_map_server(write_floor(tmp_path, TWO_ROOMS))
    random = np.random.default_rng(3)
    ends = random.uniform(0.0, 40.0, (60, 2, 2))
    blockades = tuple(
        HiddenBlockade(f"b{k}", ((a[0], a[1]), (b[0], b[1])), 1.0) for k, (a, b) in enumerate(ends)
    )
    world = World(grid, blockades)
    for x, y in random.uniform(0.0, 40.0, (200, 2)):
        reached = {
            b.id
            for b in world.blockades()
            if math.dist((x, y), nearest_on_segment((x, y), b.segment_m)) <= 3.0
        }
        assert reached <= {b.id for b in world.blockades_near((x, y), 3.0)}
    gone = next(iter(reached))
    world.clear(gone)
    assert gone not in {b.id for b in world.blockades_near((x, y), 3.0)}
