"""The attachments of the grid."""

import math
from dataclasses import replace

import pytest

from semantic_attachments import EvaluationError, Memory, RobotModel, World, bind
from semantic_attachments.path_costs import PathCosts

NAMES = ("pathCost", "exploreCost", "clearCost", "dockCost", "undockCost")


def test_durations(two_rooms: World) -> None:
    robots = {
        "quick": RobotModel("clearer", 0.3, 1.0, clear_speed_factor=2.0),
        "rover": RobotModel("rover", 0.2, 1.0, dock_duration_s=7.0, undock_duration_s=3.0),
    }
    bound = bind(NAMES, World(two_rooms.grid, two_rooms.locations, robots, two_rooms.blockades))
    assert bound["clearCost"]("quick", "door") == 10.0
    assert math.isinf(bound["clearCost"]("quick", "west"))
    assert bound["dockCost"]("rover", "quick") == 7.0
    assert bound["undockCost"].many([("rover", "quick")]) == [3.0]


@pytest.mark.parametrize("name", NAMES)
def test_an_unknown_robot_is_named(two_rooms: World, name: str) -> None:
    ways = ("pathCost", "exploreCost")
    arguments = ("ghost", "west", "east") if name in ways else ("ghost", "door")
    with pytest.raises(EvaluationError, match="no robot 'ghost'"):
        bind([name], two_rooms)[name](*arguments)


def test_a_memory_carries_path_costs_over(two_rooms: World) -> None:
    memory = Memory()
    first = bind(["pathCost"], two_rooms, memory=memory)["pathCost"]
    first("robot", "west", "door")
    again = bind(["pathCost"], two_rooms, memory=memory)["pathCost"]
    assert again.inner is first.inner
    later = replace(two_rooms, version=1)
    second = bind(["pathCost"], later, memory=memory)["pathCost"]
    second("robot", "west", "door")
    costs = second.inner
    assert isinstance(costs, PathCosts)
    assert (costs.statistics.fields, costs.statistics.kept) == (0, 1)


def test_exploring_takes_the_way_and_the_sweep_behind_it(two_rooms: World) -> None:
    robots = {"robot": RobotModel("rover", 0.2, 0.5, sensor_range_m=4.0)}
    places = {**two_rooms.locations}
    places["east"] = replace(places["east"], unknown_m2=24.0)
    bound = bind(["pathCost", "exploreCost"], replace(two_rooms, locations=places, robots=robots))
    way_s = bound["pathCost"]("robot", "west", "east")
    # 4 m to either side at 0.5 m/s: 4 m^2/s.
    assert bound["exploreCost"]("robot", "west", "east") == pytest.approx(way_s + 6.0)
    assert bound["exploreCost"]("robot", "east", "west") == pytest.approx(way_s)
