"""The Hungarian schedule on a line: by hand."""

import numpy as np
import pytest

from scenarios.benchmarks.planner.hungarian_schedule import Mission, hungarian_makespan_s
from scenarios.benchmarks.planner.large_team import Field, Ways


def on_a_line(explorers: list[float], targets: list[float], gates: list[int]) -> Mission:
    def at(places: list[float]) -> np.ndarray:
        return np.array([[x, 0.0] for x in places])

    return Mission(
        explorers_m=at(explorers),
        clearers_m=at([50.0]),
        targets_m=at(targets),
        blockades_m=at([60.0]),
        gates=np.array(gates),
        explorer_m_s=1.0,
        clearer_m_s=2.0,
        clear_s=10.0,
    )


def test_each_robot_takes_what_is_near() -> None:
    assert hungarian_makespan_s(on_a_line([0.0, 30.0], [5.0, 40.0], [-1, -1])) == 10.0


def test_one_robot_goes_from_target_to_target() -> None:
    assert hungarian_makespan_s(on_a_line([0.0], [5.0, 12.0, 20.0], [-1, -1, -1])) == 20.0


def test_a_sealed_target_waits_for_its_blockade() -> None:
    # The clearer is there after 5 s and done after 15; only then the explorer sets out.
    assert hungarian_makespan_s(on_a_line([0.0], [70.0], [0])) == pytest.approx(15.0 + 70.0)


def test_a_blockade_that_nobody_clears_is_infinite() -> None:
    mission = on_a_line([0.0], [70.0], [0])
    alone = Mission(**{**vars(mission), "clearers_m": np.zeros((0, 2))})
    assert hungarian_makespan_s(alone) == float("inf")


def test_ways_do_not_lead_through_the_wall() -> None:
    field = Field(explorers=1, clearers=1, targets=10, blockades=2, seed=1)
    ways = Ways(field)
    shut, gate = ways.many([("e0", "t0", "t9"), ("e0", "b1", "t9")])
    assert shut == float("inf")
    assert 0.0 < gate < 2_000.0
    assert field.behind == {"t9": "b1"}
