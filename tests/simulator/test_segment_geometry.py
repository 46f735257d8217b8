"""Distances to segments: by hand, and against many points along them."""

import math

import numpy as np
import pytest

from simulator.segment_geometry import cross, nearest_on_segment, segment_distance

WALL = ((1.0, -1.0), (1.0, 1.0))


@pytest.mark.parametrize(
    ("move", "crosses"),
    [
        (((0.0, 0.0), (2.0, 0.0)), True),
        (((0.0, 2.0), (2.0, 2.0)), False),
        (((0.0, 0.0), (0.9, 0.0)), False),
    ],
)
def test_a_crossing_ends_on_both_sides(
    move: tuple[tuple[float, float], tuple[float, float]], crosses: bool
) -> None:
    assert cross(move, WALL) is crosses
    assert cross(WALL, move) is crosses


def test_the_nearest_point_lies_within_the_segment() -> None:
    assert nearest_on_segment((0.0, 0.5), WALL) == (1.0, 0.5)
    assert nearest_on_segment((0.0, 7.0), WALL) == (1.0, 1.0)
    assert nearest_on_segment((3.0, 4.0), ((1.0, 1.0), (1.0, 1.0))) == (1.0, 1.0)


def test_distance_agrees_with_sampled_points() -> None:
    random = np.random.default_rng(1)
    shares = np.linspace(0.0, 1.0, 200)[:, None]
    for a, b, c, d in random.uniform(0.0, 10.0, (50, 4, 2)):
        first, second = a + shares * (b - a), c + shares * (d - c)
        sampled = np.linalg.norm(first[:, None] - second[None], axis=2).min()
        found = segment_distance((tuple(a), tuple(b)), (tuple(c), tuple(d)))
        assert found <= sampled + 1e-9
        assert sampled <= found + math.sqrt(2) * 0.06
