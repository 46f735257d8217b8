"""Time for each decision: all of it while every mission has a worker, a fair part otherwise."""

from math import inf

import pytest

from service.jobs.demand import UTILIZATION, WINDOW_S, Demand


def test_missions_that_have_a_worker_each_need_not_share() -> None:
    demand = Demand(workers=2, now_s=lambda: 0.0)
    for _ in range(100):
        demand.ask("m1")
        demand.ask("m2")
    assert demand.share_s(waiting=0) == inf


def test_the_share_keeps_workers_below_their_capacity() -> None:
    demand = Demand(workers=2, now_s=lambda: 0.0)
    for number in range(50):
        demand.ask(f"m{number % 10}")
    share_s = demand.share_s(waiting=0)
    assert share_s * 50 / WINDOW_S == pytest.approx(2 * UTILIZATION)
    assert demand.share_s(waiting=4) == pytest.approx(share_s / 3)


def test_what_was_long_ago_does_not_count() -> None:
    clock = [0.0]
    demand = Demand(workers=1, now_s=lambda: clock[0])
    for number in range(20):
        demand.ask(f"m{number}")
    assert demand.share_s(waiting=0) < inf
    clock[0] = WINDOW_S + 1.0
    assert demand.share_s(waiting=0) == inf
