"""Path costs: worked example, oracle by scipy on small random worlds, what survives a changed
map."""

import math
from dataclasses import replace
from itertools import pairwise, permutations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from semantic_attachments.contract import EvaluationError
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.robot_class import GridParameters
from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World


def test_the_blockade_a_robot_goes_to_is_open_and_every_other_one_a_wall(two_rooms: World) -> None:
    costs = PathCosts(two_rooms)
    assert math.isinf(costs("robot", "west", "east"))
    # 40 columns and 20 rows of 0.2 m at 0.5 m/s, from either side and back.
    expected_s = (20 * math.sqrt(2) + 20) * 0.2 / 0.5
    assert costs("robot", "west", "door") == pytest.approx(expected_s, abs=1e-8)
    assert costs("robot", "door", "west") == costs("robot", "west", "door")
    assert costs("robot", "door", "east") == pytest.approx(expected_s, abs=1e-8)
    assert costs("robot", "west", "west") == 0.0
    cleared = World(two_rooms.grid, _without_blockades(two_rooms), two_rooms.robots)
    assert math.isfinite(PathCosts(cleared)("robot", "west", "east"))


def test_a_robot_wider_than_the_door_does_not_pass(two_rooms: World) -> None:
    def reaches(radius_m: float) -> bool:
        robots = {"robot": RobotModel("explorer", radius_m, 1.0)}
        world = World(two_rooms.grid, _without_blockades(two_rooms), robots)
        return math.isfinite(PathCosts(world)("robot", "west", "east"))

    # The door is ten cells wide; a centre can stand on cell centres only, so at most nine half
    # cells from its posts.
    assert reaches(0.9)
    assert not reaches(1.0)


def test_names_the_world_does_not_know(two_rooms: World) -> None:
    costs = PathCosts(two_rooms)
    with pytest.raises(EvaluationError, match="no location 'north'"):
        costs("robot", "north", "west")
    with pytest.raises(EvaluationError, match="a robot and two locations"):
        costs("robot", "west")


def test_a_location_outside_of_the_map_is_out_of_reach(two_rooms: World) -> None:
    far = World(
        two_rooms.grid, {**two_rooms.locations, "moon": Location((1e9, 0.0))}, two_rooms.robots,
        two_rooms.blockades,
    )  # fmt: skip
    assert math.isinf(PathCosts(far)("robot", "west", "moon"))
    assert PathCosts(far).path("robot", "moon", "west").shape == (0, 2)


def test_terrain_bars_some_robots_and_slows_others(two_rooms: World) -> None:
    terrain = np.zeros(two_rooms.grid.cells.shape, np.uint8)
    terrain[:, 45:55] = 1
    grid = GridMap(two_rooms.grid.cells, 0.2, terrain=terrain, terrain_classes=("floor", "rubble"))
    robots = {
        "carrier": RobotModel("carrier", 0.0, 1.0, enters=("floor",)),
        "rover": RobotModel("rover", 0.0, 1.0, enters=("floor", "rubble")),
        "slow": RobotModel(
            "slow", 0.0, 1.0, enters=("floor", "rubble"), terrain_speed_m_s={"rubble": 0.25}
        ),
    }
    places = {"a": Location((8.1, 6.1)), "b": Location((12.1, 6.1))}
    costs = PathCosts(World(grid, places, robots))
    assert math.isinf(costs("carrier", "a", "b"))
    assert costs("rover", "a", "b") == pytest.approx(4.0)
    # 20 steps of 0.2 m: 9 inside the rubble at 0.25 m/s, 2 half inside, 9 outside.
    assert costs("slow", "a", "b") == pytest.approx(0.2 * (9 * 4 + 2 * 2.5 + 9), abs=1e-6)
    avoiding = GridParameters(terrain_cost=(("rubble", 3.0),))
    assert PathCosts(World(grid, places, robots), avoiding)("rover", "a", "b") > 4.0


def test_unknown_cells_are_forbidden_or_free(two_rooms: World) -> None:
    cells = two_rooms.grid.cells.copy()
    cells[:, 48:53][cells[:, 48:53] == 0] = -1
    world = World(GridMap(cells, 0.2), _without_blockades(two_rooms), two_rooms.robots)
    assert math.isinf(PathCosts(world)("robot", "west", "east"))
    optimistic = PathCosts(world, GridParameters(unknown_is_free=True))
    assert math.isfinite(optimistic("robot", "west", "east"))


def test_driving_along_walls_can_be_made_slower(two_rooms: World) -> None:
    world = World(two_rooms.grid, _without_blockades(two_rooms), two_rooms.robots)
    plain = PathCosts(world)("robot", "west", "east")
    slowed = PathCosts(world, GridParameters(wall_zone_m=1.0, wall_slowdown=5.0))
    assert slowed("robot", "west", "east") > plain
    gaps = [
        np.min(np.linalg.norm(path[:, None] - np.array([[10.1, 5.0], [10.1, 7.0]]), axis=2))
        for path in (PathCosts(world).path("robot", "west", "east"),
                     slowed.path("robot", "west", "east"))
    ]  # fmt: skip
    assert gaps[1] > gaps[0]


def test_a_path_leads_from_place_to_place_and_keeps_its_distance(two_rooms: World) -> None:
    world = World(two_rooms.grid, _without_blockades(two_rooms), two_rooms.robots)
    costs = PathCosts(world)
    path = costs.path("robot", "west", "east")
    assert tuple(path[0]) == (2.1, 2.1)
    assert tuple(path[-1]) == (18.1, 2.1)
    length_m = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert 16.0 < length_m < costs.length_m("robot", "west", "east")
    assert len(path) < 10
    assert costs.path("robot", "east", "west") == pytest.approx(path[::-1])
    walls_m = world.grid.centres_m(np.flatnonzero(world.grid.cells.ravel() == 100))
    line = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(path)])
    apart = np.maximum(np.abs(line[:, None] - walls_m[None]) - 0.1, 0.0)
    assert np.hypot(apart[..., 0], apart[..., 1]).min() > 0.3 - 0.05
    assert PathCosts(two_rooms).path("robot", "west", "east").shape == (0, 2)


def test_a_robot_beside_a_wall_begins_its_path_on_its_own_side() -> None:
    cells = np.zeros((41, 41), np.int8)
    cells[20] = 100
    places = {
        "below": Location((2.0, 1.95)),
        "above": Location((2.0, 2.15)),
        "low": Location((2, 0.5)),
    }
    robots = {"robot": RobotModel("explorer", 0.4, 1.0)}
    costs = PathCosts(World(GridMap(cells, 0.1), places, robots))
    assert math.isinf(costs("robot", "above", "low"))
    assert costs("robot", "below", "low") == pytest.approx(1.4, abs=1e-9)
    assert costs.path("robot", "below", "low")[0] == pytest.approx((2.0, 1.95))


def _without_blockades(world: World) -> dict[str, Location]:
    return {name: place for name, place in world.locations.items() if place.blockade is None}


def random_world(rng: np.random.Generator) -> World:
    """A small map with walls, places on free ground, blockades and two classes of robots."""
    cells = np.where(rng.random((14, 18)) < 0.12, 100, 0).astype(np.int8)
    grid = GridMap(cells, resolution_m=0.5)
    places = {
        f"place_{i}": Location((rng.uniform(0, 9), rng.uniform(0, 7))) for i in range(4)
    }  # fmt: skip
    blockades = {}
    for index in range(int(rng.integers(0, 4))):
        x, y = rng.uniform(0, 9), rng.uniform(0, 7)
        end = (x + rng.uniform(-2, 2), y + rng.uniform(-2, 2))
        blockades[f"blockade_{index}"] = Blockade(f"blockade_{index}", ((x, y), end), 5.0)
    places |= {name: Location(b.centre_m, name) for name, b in blockades.items()}
    robots = {"thin": RobotModel("thin", 0.1, 1.0), "thick": RobotModel("thick", 0.4, 2.0)}
    return World(grid, places, robots, blockades)


def oracle_s(world: World, robot: str, start: str, goal: str) -> float | None:
    """Travel time by the definition, or None if a place is not where the robot can stand."""
    model, grid = world.robots[robot], world.grid
    solid = grid.cells >= 65
    ends = {world.locations[start].blockade, world.locations[goal].blockade}
    for name, blockade in world.blockades.items():
        if name not in ends:
            solid.ravel()[blockade.cells(grid)] = True
    passable = ~_inflated(solid, model.radius_m / grid.resolution_m)
    cells = [grid.cell_at(world.locations[name].position_m) for name in (start, goal)]
    if any(cell is None or not passable.ravel()[cell] for cell in cells):
        return None
    rows, columns = np.nonzero(passable)
    edges: list[tuple[int, int, float]] = []
    for row, column in zip(rows, columns, strict=True):
        for up, right in [(0, 1), (1, 0), (1, 1), (1, -1)]:
            r, c = row + up, column + right
            if 0 <= r < grid.height and 0 <= c < grid.width:
                corners = passable[row, c] and passable[r, column] and passable[r, c]
                if corners:
                    a, b = row * grid.width + column, r * grid.width + c
                    edges.append((a, b, math.hypot(up, right)))
    if not edges:
        return 0.0 if cells[0] == cells[1] else math.inf
    a, b, lengths = (np.array(values) for values in zip(*edges, strict=True))
    size = grid.cells.size
    graph = coo_array((lengths, (a.astype(int), b.astype(int))), (size, size)).tocsr()
    distance = dijkstra(graph, directed=False, indices=cells[0])[cells[1]]
    return float(distance * grid.resolution_m / model.speed_m_s)


def _inflated(solid: NDArray[np.bool_], radius_cells: float) -> NDArray[np.bool_]:
    """Cells whose centres are nearer to an obstacle's square or to the border than the radius."""
    rows, columns = np.indices(solid.shape)
    border = np.minimum(np.minimum(rows, rows[::-1]), np.minimum(columns, columns[:, ::-1])) + 0.5
    covered = solid | (border < radius_cells - 1e-9)
    for row, column in zip(*np.nonzero(solid), strict=True):
        up = np.maximum(np.abs(rows - row) - 0.5, 0)
        right = np.maximum(np.abs(columns - column) - 0.5, 0)
        covered |= np.hypot(up, right) < radius_cells - 1e-9
    return covered


@pytest.mark.parametrize("seed", range(8))
def test_costs_equal_the_definition(seed: int) -> None:
    world = random_world(np.random.default_rng(seed))
    calls = [
        (robot, start, goal)
        for robot in world.robots
        for start, goal in permutations(world.locations, 2)
    ]
    found = PathCosts(world).many(calls)
    one_by_one = PathCosts(world)
    compared = 0
    for call, cost_s in zip(calls, found, strict=True):
        expected_s = oracle_s(world, *call)
        assert one_by_one(*call) == cost_s
        if expected_s is not None:
            compared += 1
            assert cost_s == pytest.approx(expected_s, abs=2e-9)
    assert compared > 5


@pytest.mark.parametrize("seed", range(6))
def test_any_angle_paths_are_at_most_as_long(seed: int) -> None:
    world = random_world(np.random.default_rng(seed))
    calls = [
        (robot, start, goal)
        for robot in world.robots
        for start, goal in permutations(world.locations, 2)
    ]
    steps = PathCosts(world).many(calls)
    lines = PathCosts(world, GridParameters(any_angle=True))
    for call, along_steps_s, along_lines_s in zip(calls, steps, lines.many(calls), strict=True):
        assert math.isinf(along_lines_s) == math.isinf(along_steps_s)
        if math.isfinite(along_steps_s):
            assert along_steps_s / 1.0824 - 1e-9 <= along_lines_s <= along_steps_s * 1.02 + 1e-9
            path = lines.path(*call)
            assert path[0] == pytest.approx(world.locations[call[1]].position_m)
            assert path[-1] == pytest.approx(world.locations[call[2]].position_m)


@pytest.mark.parametrize("any_angle", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_what_is_kept_equals_what_would_be_computed(seed: int, any_angle: bool) -> None:
    rng = np.random.default_rng(100 + seed)
    world = random_world(rng)
    parameters = GridParameters(any_angle=any_angle)
    costs = PathCosts(world, parameters)
    for step in range(5):
        calls = [
            (robot, start, goal)
            for robot in world.robots
            for start, goal in permutations(world.locations, 2)
        ]
        fresh = PathCosts(world, parameters)
        assert costs.many(calls) == fresh.many(calls), f"after {step} changes"
        world = _changed(world, rng)
        costs = costs.after(world)


def _changed(world: World, rng: np.random.Generator) -> World:
    blockades, places = dict(world.blockades), dict(world.locations)
    grid = world.grid
    if blockades and rng.random() < 0.5:
        gone = sorted(blockades)[int(rng.integers(len(blockades)))]
        del blockades[gone], places[gone]
    else:
        x, y = rng.uniform(0, 9), rng.uniform(0, 7)
        name = f"new_{rng.integers(10**6)}"
        end = (x + rng.uniform(-2, 2), y + rng.uniform(-2, 2))
        blockades[name] = Blockade(name, ((x, y), end), 5.0)
        places[name] = Location(blockades[name].centre_m, name)
    if rng.random() < 0.5:
        cells = grid.cells.copy()
        cells.ravel()[rng.integers(cells.size, size=3)] = rng.choice([0, 100])
        grid = GridMap(cells, grid.resolution_m)
    places["place_0"] = Location((rng.uniform(0, 9), rng.uniform(0, 7)))
    return replace(world, grid=grid, blockades=blockades, locations=places)


def test_a_blockade_in_one_room_forgets_that_room_only(two_rooms: World) -> None:
    open_door = World(two_rooms.grid, _without_blockades(two_rooms), two_rooms.robots)
    costs = PathCosts(open_door)
    calls = [("robot", a, b) for a, b in permutations(open_door.locations, 2)]
    costs.many(calls)
    rubble = Blockade("rubble", ((16.1, 0.0), (16.1, 5.0)), 3.0)
    places = {**open_door.locations, "rubble": Location(rubble.centre_m, "rubble")}
    after = costs.after(World(two_rooms.grid, places, two_rooms.robots, {"rubble": rubble}))
    assert (after.statistics.kept, after.statistics.forgotten) == (1, 2)
    after.many(calls)
    assert after.statistics.fields == 1
