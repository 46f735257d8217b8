"""What robots know, tell, take along and merge."""

from pathlib import Path

import numpy as np

from simulator.fleet_client import Command
from simulator.fleet_scenario import HiddenBlockade
from simulator.knowledge import Ending, Knowledge, Order
from simulator.mapping.sensed_map import SensedMap
from simulator.navigation import Navigation
from simulator.occupancy_grid import read_map_server
from simulator.sensors import Scan
from tests.simulator.floors import TWO_ROOMS, write_floor

ONE = HiddenBlockade("one", ((9.5, 3.0), (9.5, 4.0)), 5.0)
TWO = HiddenBlockade("two", ((3.0, 1.0), (3.0, 2.0)), 5.0)


def knowledge(folder: Path) -> Knowledge:
    return Knowledge(Navigation(read_map_server(write_floor(folder, TWO_ROOMS))))


def test_a_copy_learns_on_its_own(tmp_path: Path) -> None:
    first = knowledge(tmp_path)
    first.sense(ONE, 1.0)
    second = first.copy()
    second.sense(TWO, 2.0)
    second.see_dead("robot", (1.0, 1.0, 0.3))
    assert list(first.navigation.known) == ["one"]
    assert first.navigation.standing == []
    assert list(second.navigation.known) == ["one", "two"]
    assert second.untold == ["one", "two"]


def test_what_somebody_has_seen_gone_is_gone_for_all(tmp_path: Path) -> None:
    first, second = knowledge(tmp_path), knowledge(tmp_path)
    first.sense(ONE, 1.0)
    second.sense(ONE, 3.0)
    second.see_gone("one")
    first.merge([second])
    assert first.navigation.known == {}
    assert first.sensed == {"one": 1.0}
    assert first.cleared == {"one"}


def test_nothing_is_told_twice(tmp_path: Path) -> None:
    first = knowledge(tmp_path)
    first.sense(ONE, 1.0)
    first.endings.append(Ending("robot", "r1-robot", 2.0, (1.0, 1.0)))
    second = first.copy()
    first.tell()
    assert not first.has_news
    second.sense(TWO, 4.0)
    first.merge([second])
    assert first.untold == ["two"]
    assert first.endings == []


def test_the_newest_order_counts(tmp_path: Path) -> None:
    first, second = knowledge(tmp_path), knowledge(tmp_path)
    first.orders = {"a": Order(3, None), "b": Order(3, None)}
    newer = Order(5, Command("r5-a", "a", "explore", "target"))
    second.orders = {"a": newer, "b": Order(2, None)}
    first.merge([second])
    assert first.orders == {"a": newer, "b": Order(3, None)}


def test_merging_does_not_depend_on_who_merges(tmp_path: Path) -> None:
    first, second = knowledge(tmp_path), knowledge(tmp_path)
    first.sense(ONE, 1.0)
    first.endings.append(Ending("b", "r1-b", 2.0, (1.0, 1.0)))
    second.sense(TWO, 0.5)
    second.endings.append(Ending("a", "r1-a", 1.0, (1.0, 1.0), "path blocked"))
    one, other = first.copy(), second.copy()
    one.merge([second])
    other.merge([first])
    assert one.untold == other.untold == ["two", "one"]
    assert one.endings == other.endings
    again = one.copy()
    again.merge([second, first])
    assert (again.untold, again.endings) == (one.untold, one.endings)


def test_maps_are_merged_and_ways_found_on_what_both_have_seen(tmp_path: Path) -> None:
    grid = read_map_server(write_floor(tmp_path, TWO_ROOMS))

    def seen_from(x: float) -> Knowledge:
        sensed = SensedMap(grid)
        ranges = np.full(90, 2.0, dtype=np.float32)
        sensed.insert(Scan("robot", 0.0, (x, 3.5, 0.0), 3.0, ranges, ()), [])
        return Knowledge(Navigation(sensed.grid()), sensed)

    first, second = seen_from(4.0), seen_from(14.0)
    before = first.navigation.grid.cells.copy()
    first.merge([second])
    after = first.navigation.grid.cells
    assert before[35, 140] == -1
    assert after[35, 140] == 0
    assert (after >= 0).sum() > (before >= 0).sum()
