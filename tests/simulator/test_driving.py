"""Robots that stand close to one another get away from there, touching nothing."""

import math
from pathlib import Path

import numpy as np
import pytest

from simulator.driving import Driving
from simulator.fleet_scenario import Point
from simulator.navigation import Navigation
from simulator.occupancy_grid import read_map_server
from simulator.right_of_way import RightOfWay
from simulator.robot import Robot
from simulator.world import World
from tests.simulator.floors import EXPLORER, write_floor

HALL = """
################
#..............#
#..............#
#..............#
################
"""
STEP_S = 0.05


class Hall:
    """Robots in a hall of 14 x 3 m, each on its way to a goal."""

    def __init__(self, folder: Path, starts: list[Point], goals: list[Point]) -> None:
        grid = read_map_server(write_floor(folder, HALL))
        self.world, navigation = World(grid, ()), Navigation(grid)
        self.right_of_way = RightOfWay(navigation)
        self.driving = Driving(self.world, navigation)
        self.robots = [
            Robot(f"robot_{k}", EXPLORER, *start, heading_rad=2.0 * k)
            for k, start in enumerate(starts)
        ]
        for robot, goal in zip(self.robots, goals, strict=True):
            self.world.place(robot.id, robot.kind.radius_m, robot.pose)
            robot.goals = [goal]
            robot.follow(navigation.route(robot, [goal]) or [])

    def drive(self, limit_s: float) -> float | None:
        """Drives until all have arrived; the time that took, or None."""
        for step in range(round(limit_s / STEP_S)):
            time_s = step * STEP_S
            if step % 10 == 0:
                self.right_of_way.update(self.robots, time_s)
            self.driving.drive(self.robots, time_s, STEP_S)
            self.world.step(STEP_S)
            for robot in self.robots:
                robot.x, robot.y, robot.heading_rad = self.world.pose(robot.id)
                if math.dist(robot.position, robot.goals[0]) < 0.3:
                    robot.route, robot.timed = [], []
            if all(math.dist(r.position, r.goals[0]) < 0.3 for r in self.robots):
                return time_s
        return None


def test_two_that_face_one_another_pass(tmp_path: Path) -> None:
    hall = Hall(tmp_path, [(6.21, 2.91), (6.17, 2.29)], [(10.0, 2.1), (1.5, 3.4)])
    took_s = hall.drive(30.0)
    assert took_s is not None
    assert took_s < 15.0
    assert hall.world.contacts.robot == hall.world.contacts.wall == 0


@pytest.mark.parametrize("seed", range(20))
def test_two_that_all_but_touch_part(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    first = random.uniform([3.0, 2.0], [11.0, 3.0])
    angle = random.uniform(0.0, math.tau)
    second = first + 0.621 * np.array([math.cos(angle), math.sin(angle)])
    second[1] = np.clip(second[1], 1.4, 3.6)
    if np.linalg.norm(first - second) < 0.605:
        second = first + np.array([0.621, 0.0])
    goals = random.uniform([1.5, 1.5], [14.5, 3.5], size=(2, 2))
    if math.dist(*goals) < 0.9:
        goals[1, 0] = goals[0, 0] + (1.0 if goals[0, 0] < 8.0 else -1.0)
    hall = Hall(tmp_path, [tuple(first), tuple(second)], [tuple(goal) for goal in goals])
    assert hall.drive(60.0) is not None
    assert hall.world.contacts.robot == hall.world.contacts.wall == 0


@pytest.mark.parametrize("seed", range(4))
def test_six_change_sides(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    rows = [1.6, 2.5, 3.4]
    left, right = [(3.0, y) for y in rows], [(12.0, y) for y in rows]
    goals = [tuple(right[k]) for k in random.permutation(3)]
    goals += [tuple(left[k]) for k in random.permutation(3)]
    hall = Hall(tmp_path, [*left, *right], goals)
    assert hall.drive(120.0) is not None
    assert hall.world.contacts.robot == hall.world.contacts.wall == 0
