"""The motion attachment: worker processes, lower bounds, failures."""

import math
from collections.abc import Iterator
from dataclasses import replace
from time import monotonic

import numpy as np
import pytest

from semantic_attachments import Blockade, EvaluationError, Memory, RobotModel, World, bind
from semantic_attachments.motion import MotionCosts, MotionWorkers, motion_costs
from semantic_attachments.motion_parameters import MotionParameters
from semantic_attachments.motion_worker import MotionWorker, Query

PARAMETERS = MotionParameters(budget_s=0.2)
CAR = RobotModel(
    "car",
    radius_m=0.5,
    speed_m_s=0.5,
    kinematics="reeds-shepp",
    footprint_m=((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)),
)


@pytest.fixture(scope="module")
def memory() -> Iterator[Memory]:
    """One set of worker processes for all tests."""
    memory = Memory()
    yield memory
    workers = memory.get("motion", MotionWorkers)
    if workers is not None:
        workers.close()


@pytest.fixture
def costs(two_rooms: World, memory: Memory) -> MotionCosts:
    robots = {"car": CAR, "robot": two_rooms.robots["robot"]}
    return motion_costs(replace(two_rooms, robots=robots), memory, PARAMETERS)


def test_the_blockade_at_an_end_is_open_and_every_other_one_a_wall(costs: MotionCosts) -> None:
    calls = [("car", "west", goal) for goal in ("west", "also_west", "door", "east")]
    same, near, door, far = costs.many(calls)
    assert same == 0.0
    assert 12.6 <= near < 14
    assert 17.8 <= door < 20
    assert far == math.inf
    assert costs("car", "door", "east") < math.inf


def test_lower_bounds_are_below_the_durations(costs: MotionCosts) -> None:
    calls = [
        (robot, start, goal)
        for robot in ("car", "robot")
        for start in costs.world.locations
        for goal in costs.world.locations
    ]
    for bound_s, duration_s in zip(costs.lower_bounds(calls), costs.many(calls), strict=True):
        assert bound_s <= duration_s


def test_paths_are_poses_from_place_to_place(costs: MotionCosts) -> None:
    poses = costs.path("car", "west", "door")
    assert poses.shape[1] == 3
    assert poses[0, :2] == pytest.approx((2.1, 2.1))
    assert poses[-1, :2] == pytest.approx((10.1, 6.0))
    assert costs.path("car", "west", "east").shape == (0, 3)


def test_faulty_calls_are_named(costs: MotionCosts) -> None:
    with pytest.raises(EvaluationError, match="no robot 'ghost'"):
        costs("ghost", "west", "east")
    with pytest.raises(EvaluationError, match="no location 'moon'"):
        costs("car", "west", "moon")
    with pytest.raises(EvaluationError, match="two locations"):
        costs("car", "west")


def test_a_worker_that_died_is_an_error_and_the_next_call_gets_another(
    costs: MotionCosts, memory: Memory
) -> None:
    workers = memory.get("motion", MotionWorkers)
    assert workers is not None
    workers.of(CAR)._process.kill()
    fresh = MotionCosts(costs.world, workers)
    try:
        first = fresh("car", "west", "also_west")
    except EvaluationError:  # it had not ended yet when it was asked
        first = fresh("car", "west", "also_west")
    assert first == pytest.approx(costs("car", "west", "also_west"))


def test_a_worker_that_takes_too_long_is_given_up(two_rooms: World) -> None:
    worker = MotionWorker(CAR, PARAMETERS)
    query = Query((2.1, 2.1), ((4.1, 8.1),), ())
    worker.ask(two_rooms.grid, [query])
    with pytest.raises(EvaluationError, match="took too long"):
        worker.answer(monotonic())
    assert not worker.alive


def test_a_fault_in_the_worker_is_told(two_rooms: World) -> None:
    worker = MotionWorker(CAR, PARAMETERS)
    try:
        worker.ask(two_rooms.grid, [Query((np.nan, 2.1), ((4.1, 8.1),), ())])
        with pytest.raises(EvaluationError, match="motion planning failed: ValueError"):
            worker.answer(monotonic() + 60)
        worker.ask(two_rooms.grid, [Query((2.1, 2.1), ((4.1, 8.1),), ())])
        ((duration_s,),) = worker.answer(monotonic() + 60)
        assert math.isfinite(duration_s)
    finally:
        worker.close()


def test_what_a_change_cannot_touch_is_kept(costs: MotionCosts) -> None:
    world, memory = costs.world, Memory()
    memory.keep("motion", costs.workers)
    costs = motion_costs(world, memory, PARAMETERS)
    calls = [("car", a, b) for a in world.locations for b in world.locations]
    before_s = dict(zip(calls, costs.many(calls), strict=True))
    rubble = Blockade("rubble", ((17.1, 0.5), (17.1, 3.5)), 3.0)
    changed = replace(world, blockades={**world.blockades, "rubble": rubble}, version=1)
    after = motion_costs(changed, memory, PARAMETERS)
    assert 0 < after.kept < len(calls)
    now_s = dict(zip(calls, after.many(calls), strict=True))
    fresh_s = MotionCosts(changed, costs.workers).many(calls)
    assert list(now_s.values()) == pytest.approx(fresh_s, rel=0.02)
    west = ("car", "west", "also_west")
    assert now_s[west] == before_s[west]
    assert now_s["car", "door", "east"] > before_s["car", "door", "east"]
    again = motion_costs(world, memory, PARAMETERS)
    assert again.many(calls) == pytest.approx(list(before_s.values()), rel=0.02)


def test_it_is_installed(two_rooms: World) -> None:
    bound = bind(["motionCost@libmotion.so"], two_rooms)
    assert bound["motionCost"]("robot", "west", "west") == 0.0
