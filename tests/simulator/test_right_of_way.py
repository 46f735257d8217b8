"""Who gives way: announced motions, the order of priority, and motions that meet nobody."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from simulator.fleet_client import Command
from simulator.fleet_scenario import Point
from simulator.knowledge import Knowledge
from simulator.navigation import Navigation
from simulator.occupancy_grid import read_map_server
from simulator.right_of_way import RightOfWay, RightOfWaySettings
from simulator.robot import Robot
from tests.simulator.floors import EXPLORER, write_floor

CORRIDOR = """
####################
######.#############
#..................#
####################
"""
"""A corridor one metre wide with a niche."""


class Meeting:
    """Robots on straight ways along the corridor."""

    def __init__(self, folder: Path, ways: Sequence[tuple[Point, Point]]) -> None:
        navigation = Navigation(read_map_server(write_floor(folder, CORRIDOR)))
        self.robots = [Robot(f"r{k}", EXPLORER, *a, 0.0) for k, (a, _) in enumerate(ways)]
        known = dict.fromkeys([robot.id for robot in self.robots], Knowledge(navigation))
        self.right_of_way = RightOfWay(known)
        for robot, (start, goal) in zip(self.robots, ways, strict=True):
            robot.command, robot.command_over = Command(robot.id, robot.id, "explore", "g"), False
            robot.goals = [goal]
            robot.follow([start, goal])

    def least_gap_m(self) -> float:
        """How near the two first robots come to one another as announced."""
        first, second = (self.right_of_way.announced(r, 0.0) for r in self.robots[:2])
        return float(np.linalg.norm(first - second, axis=1).min())


def test_a_route_is_announced_at_the_robots_speed(tmp_path: Path) -> None:
    meeting = Meeting(tmp_path, [((2.0, 1.5), (12.0, 1.5))])
    motion = meeting.right_of_way.announced(meeting.robots[0], 0.0)
    settings = RightOfWaySettings()
    assert len(motion) == round(settings.window_s / settings.period_s) + 1
    assert motion[5] == pytest.approx([2.0 + 5 * settings.period_s, 1.5])
    assert motion[-1] == pytest.approx([12.0, 1.5])


def test_a_robot_at_work_announces_that_it_stays(tmp_path: Path) -> None:
    meeting = Meeting(tmp_path, [((2.0, 1.5), (12.0, 1.5))])
    meeting.robots[0].activity = "clearing"
    assert np.unique(meeting.right_of_way.announced(meeting.robots[0], 0.0), axis=0).tolist() == [
        [2.0, 1.5]
    ]


def test_robots_that_do_not_meet_are_left_alone(tmp_path: Path) -> None:
    meeting = Meeting(tmp_path, [((2.0, 1.5), (6.0, 1.5)), ((9.0, 1.5), (17.0, 1.5))])
    meeting.right_of_way.update(meeting.robots, 0.0)
    assert meeting.right_of_way.plans == 0
    assert all(not robot.timed for robot in meeting.robots)


def test_of_two_that_meet_one_gives_way(tmp_path: Path) -> None:
    meeting = Meeting(tmp_path, [((3.5, 1.5), (12.0, 1.5)), ((9.5, 1.5), (1.6, 1.5))])
    assert meeting.least_gap_m() < 2 * EXPLORER.radius_m
    meeting.right_of_way.update(meeting.robots, 0.0)
    assert meeting.least_gap_m() >= 2 * EXPLORER.radius_m
    assert sum(bool(robot.timed) for robot in meeting.robots) == 1


def test_whoever_clears_goes_before_whoever_explores(tmp_path: Path) -> None:
    ways = [((3.5, 1.5), (12.0, 1.5)), ((9.5, 1.5), (1.6, 1.5))]
    for clearing in (0, 1):
        meeting = Meeting(tmp_path, ways)
        meeting.robots[clearing].command = Command("c", f"r{clearing}", "clear", "b")
        meeting.right_of_way.update(meeting.robots, 0.0)
        assert not meeting.robots[clearing].timed
        assert meeting.robots[1 - clearing].timed


def test_a_robot_brought_to_the_front_keeps_its_way_for_a_while(tmp_path: Path) -> None:
    meeting = Meeting(tmp_path, [((3.5, 1.5), (12.0, 1.5)), ((9.5, 1.5), (1.6, 1.5))])
    meeting.right_of_way.to_front(meeting.robots[1], 0.0, "")
    meeting.right_of_way.update(meeting.robots, 0.0)
    assert not meeting.robots[1].timed
    assert meeting.robots[0].timed


def test_an_idle_robot_makes_room(tmp_path: Path) -> None:
    """It stands in the way of one that can only go past it through the niche."""
    meeting = Meeting(tmp_path, [((2.0, 1.5), (17.0, 1.5)), ((7.5, 1.5), (7.5, 1.5))])
    idle = meeting.robots[1]
    idle.stop()
    idle.command_over = True
    for step in range(4):
        meeting.right_of_way.update(meeting.robots, 0.5 * step)
    assert idle.timed
    _, x, y = idle.timed[-1]
    assert math.dist((x, y), (7.5, 1.5)) > EXPLORER.radius_m


def test_an_idle_robot_between_two_leaves(tmp_path: Path) -> None:
    """Both are too near for it to find a motion past them: it goes first, and they wait."""
    ways = [((5.7, 1.5), (17.0, 1.5)), ((7.3, 1.5), (2.0, 1.5)), ((6.5, 1.5), (6.5, 1.5))]
    meeting = Meeting(tmp_path, ways)
    idle = meeting.robots[2]
    idle.stop()
    idle.command_over = True
    for step in range(4):
        meeting.right_of_way.update(meeting.robots, 0.5 * step)
    assert len(idle.timed) > 1
    _, x, y = idle.timed[-1]
    assert (x, y) == pytest.approx((6.5, 2.5), abs=0.3)


def test_a_dead_robot_is_nobody_to_negotiate_with(tmp_path: Path) -> None:
    meeting = Meeting(tmp_path, [((2.0, 1.5), (17.0, 1.5)), ((7.5, 1.5), (7.5, 1.5))])
    dead = meeting.robots[1]
    dead.stop()
    dead.activity = "failed"
    meeting.right_of_way.update(meeting.robots, 0.0)
    assert not dead.timed


def test_a_motion_that_gives_way_is_dropped_once_the_way_is_free(tmp_path: Path) -> None:
    meeting = Meeting(tmp_path, [((3.5, 1.5), (12.0, 1.5)), ((9.5, 1.5), (1.6, 1.5))])
    meeting.right_of_way.update(meeting.robots, 0.0)
    (giving,) = [robot for robot in meeting.robots if robot.timed]
    alone = [giving]
    for step in range(1, 8):
        meeting.right_of_way.update(alone, 0.5 * step)
    assert not giving.timed
    assert giving.route[-1] == giving.goals[0]
