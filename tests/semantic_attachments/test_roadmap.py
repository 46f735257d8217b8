"""Motions of robots that are no discs: short where the way is open, none through narrow gaps."""

import math
from dataclasses import replace

import numpy as np
import pytest

from semantic_attachments.motion_parameters import MotionParameters
from semantic_attachments.motion_space import quiet_and_seeded
from semantic_attachments.outline import Outline
from semantic_attachments.roadmap import Roadmap
from semantic_attachments.robot_model import KINEMATICS, RobotModel
from semantic_attachments.world import Blockade, GridMap

from .conftest import rooms

GRID = GridMap(rooms(), resolution_m=0.2)
DOOR = Blockade("door", ((10.1, 5.0), (10.1, 7.0)), 20.0)
WEST, EAST = (2.1, 2.1), (18.1, 2.1)
PARAMETERS = MotionParameters(budget_s=0.2)

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def car(kinematics: str, width_m: float, length_m: float = 1.6) -> RobotModel:
    x, y = length_m / 2, width_m / 2
    corners = ((-x, -y), (x, -y), (x, y), (-x, y))
    return RobotModel(
        "car",
        radius_m=y,
        speed_m_s=0.5,
        kinematics=kinematics,
        footprint_m=() if kinematics == "disc" else corners,
        turning_radius_m=1.2,
    )


@pytest.fixture(autouse=True)
def _quiet() -> None:
    quiet_and_seeded(0)


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_a_motion_is_free_and_takes_as_long_as_it_is_driven(kinematics: str) -> None:
    model = car(kinematics, width_m=0.8)
    (motion,) = Roadmap(model, GRID, PARAMETERS).motions(WEST, [EAST], [])
    assert motion.poses[0, :2] == pytest.approx(WEST)
    assert motion.poses[-1, :2] == pytest.approx(EAST)
    steps_m = np.linalg.norm(np.diff(motion.poses[:, :2], axis=0), axis=1)
    assert steps_m.max() < 0.11
    driven_s = steps_m.sum() / 0.5
    turned_s = np.abs(np.diff(np.unwrap(motion.poses[:, 2]))).sum() if kinematics == "se2" else 0.0
    assert motion.duration_s == pytest.approx(driven_s + turned_s, rel=0.02)
    poses = motion.poses.copy()
    poses[:, 2] = np.unwrap(poses[:, 2])
    times = np.arange(len(poses))
    finely = np.linspace(0, times[-1], 5 * len(poses))
    between = np.stack([np.interp(finely, times, poses[:, axis]) for axis in range(3)], axis=1)
    # A twentieth of a cell: between checked poses the outline's corners sweep a little wider.
    slightly_smaller = car(kinematics, width_m=0.78, length_m=1.58)
    assert Outline(slightly_smaller, GRID).all_free(between)


@pytest.mark.parametrize("kinematics", ["dubins", "reeds-shepp"])
def test_no_car_passes_a_gap_narrower_than_its_outline(kinematics: str) -> None:
    """The door is 2 m wide."""
    passes = {}
    for width_m in (1.6, 2.1):
        roadmap = Roadmap(car(kinematics, width_m), GRID, PARAMETERS)
        passes[width_m] = math.isfinite(roadmap.motions(WEST, [EAST], [])[0].duration_s)
    assert passes == {1.6: True, 2.1: False}


def test_a_closed_blockade_bars_the_way_and_an_opened_one_does_not() -> None:
    roadmap = Roadmap(car("reeds-shepp", 0.8), GRID, PARAMETERS)
    free, open_again = [], []
    for durations_s, closed in ((free, []), ([], [DOOR]), (open_again, [])):
        durations_s += [m.duration_s for m in roadmap.motions(WEST, [EAST, (4.0, 8.0)], closed)]
        if closed:
            assert durations_s[0] == math.inf
            assert durations_s[1] == free[1]
    # Shortcuts found meanwhile may have made it quicker.
    assert np.all(np.array(open_again) <= free)


def test_a_robot_that_a_blockade_stopped_may_leave() -> None:
    roadmap = Roadmap(car("disc", 0.8), GRID, PARAMETERS)
    beside = (9.65, 6.0)
    back, through = roadmap.motions(beside, [WEST, EAST], [DOOR])
    assert math.isfinite(back.duration_s)
    assert through.duration_s == math.inf
    arriving, past = roadmap.motions(WEST, [beside, EAST], [DOOR])
    assert math.isfinite(arriving.duration_s)
    assert past.duration_s == math.inf


def test_a_place_beside_a_wall_is_reached_on_its_own_side() -> None:
    roadmap = Roadmap(car("disc", 0.8), GRID, PARAMETERS)
    east, west = roadmap.motions(WEST, [(10.25, 2.0), (9.95, 2.0)], [DOOR])
    assert east.duration_s == math.inf
    assert west.poses[-1, 0] < 9.8


def test_what_the_roadmap_does_not_connect_rrt_connect_does(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two random poses and no guide: the motion, and a shorter one, become part of the roadmap."""
    few = replace(PARAMETERS, most_samples=2, budget_s=4.0, improvement_s=0.3)
    durations_s = {}
    for improvement_s in (0.0, 0.3):
        roadmap = Roadmap(car("reeds-shepp", 0.8), GRID, replace(few, improvement_s=improvement_s))
        monkeypatch.setattr(roadmap._guide, "poses", lambda *_: [])
        (durations_s[improvement_s],) = roadmap.durations_s(WEST, [EAST], [])
        assert roadmap.durations_s(WEST, [EAST], []) == [durations_s[improvement_s]]
    assert all(32.0 <= duration_s < 60.0 for duration_s in durations_s.values())


def test_equal_seeds_give_equal_motions() -> None:
    model = car("reeds-shepp", 0.8)
    first, again, other = (
        Roadmap(model, GRID, replace(PARAMETERS, seed=seed)).motions(WEST, [EAST], [])[0]
        for seed in (1, 1, 2)
    )
    assert np.array_equal(first.poses, again.poses)
    assert not np.array_equal(first.poses, other.poses)


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_on_an_open_map_a_point_drives_straight(kinematics: str) -> None:
    model = replace(car(kinematics, 0.8), radius_m=0.0, footprint_m=(), turning_radius_m=0.2)
    grid = GridMap(np.zeros((100, 100), np.int8), resolution_m=0.2)
    roadmap = Roadmap(model, grid, PARAMETERS)
    goals = [(18.0, 3.0), (11.0, 17.0), (3.0, 15.0)]
    for motion, goal in zip(roadmap.motions((2.0, 2.0), goals, []), goals, strict=True):
        straight_s = math.dist((2.0, 2.0), goal) / 0.5
        assert straight_s - 1e-9 <= motion.duration_s < 1.05 * straight_s
