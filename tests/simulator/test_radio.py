"""Who hears whom: worked examples, and the laws of groups."""

import math

import numpy as np
import pytest

from simulator.fleet_scenario import Point
from simulator.radio import Radio, everybody

BASE = (0.0, 0.0)


def test_a_chain_of_robots_reaches_the_base() -> None:
    groups = Radio(10.0, BASE).groups({"near": (9.0, 0.0), "mid": (18.0, 0.0), "far": (27.0, 0.0)})
    assert groups.of_base == ("near", "mid", "far")


def test_a_chain_breaks_where_one_is_missing() -> None:
    groups = Radio(10.0, BASE).groups({"near": (9.0, 0.0), "a": (25.0, 0.0), "b": (30.0, 0.0)})
    assert groups.members == (("near",), ("a", "b"))
    assert groups.of_base == ("near",)


def test_two_that_hear_the_base_hear_one_another_through_it() -> None:
    groups = Radio(10.0, BASE).groups({"west": (-9.0, 0.0), "out": (40.0, 0.0), "east": (9.0, 0.0)})
    assert groups.members == (("west", "east"), ("out",))
    assert groups.linked == 0


def test_a_dead_radio_relays_nothing() -> None:
    places: dict[str, Point] = {"near": (9.0, 0.0), "far": (18.0, 0.0)}
    assert Radio(10.0, BASE).groups(places, {"near"}).of_base == ()
    assert Radio(10.0, BASE).groups(places, {"near"}).linked is None


@pytest.mark.parametrize("seed", range(5))
def test_groups_are_the_connected_parts(seed: int) -> None:
    """Against a search that starts from every robot."""
    random = np.random.default_rng(seed)
    places = {
        f"r{k}": (float(x), float(y)) for k, (x, y) in enumerate(random.uniform(0, 50, (25, 2)))
    }
    radio = Radio(8.0, (25.0, 25.0))
    groups = radio.groups(places)
    nodes = {**places, "base": radio.base_m}

    def reached(start: str) -> set[str]:
        found, open_list = {start}, [start]
        while open_list:
            here = nodes[open_list.pop()]
            new = {n for n, at in nodes.items() if math.dist(at, here) <= 8.0} - found
            found |= new
            open_list += sorted(new)
        return found - {"base"}

    assert sorted(name for members in groups.members for name in members) == sorted(places)
    for members in groups.members:
        assert set(members) == reached(members[0])
    assert set(groups.of_base) == reached("base")


def test_without_limits_all_are_one_group() -> None:
    assert everybody(["a", "b"]).of_base == ("a", "b")
