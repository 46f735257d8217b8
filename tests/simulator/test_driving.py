"""Robots that stand close to one another get away from there, touching nothing."""

import math
from pathlib import Path

import numpy as np
import pytest

from simulator.driving import Driving
from simulator.fleet_scenario import MARGIN_M, HiddenBlockade, Point, RobotType
from simulator.knowledge import Knowledge
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

    def __init__(
        self,
        folder: Path,
        starts: list[Point],
        goals: list[Point],
        kind: RobotType = EXPLORER,
        blockades: tuple[HiddenBlockade, ...] = (),
    ) -> None:
        grid = read_map_server(write_floor(folder, HALL))
        self.world, navigation = World(grid, blockades), Navigation(grid)
        navigation.known.update((blockade.id, blockade) for blockade in blockades)
        self.robots = [
            Robot(f"robot_{k}", kind, *start, heading_rad=2.0 * k) for k, start in enumerate(starts)
        ]
        known = dict.fromkeys([robot.id for robot in self.robots], Knowledge(navigation))
        self.right_of_way = RightOfWay(known)
        self.driving = Driving(self.world, known)
        self.tracks: list[list[tuple[float, float, float]]] = [[] for _ in self.robots]
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
            for robot, track in zip(self.robots, self.tracks, strict=True):
                track.append(robot.pose)
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


@pytest.mark.parametrize("seed", range(30))
def test_around_the_loose_end_of_a_blockade(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    end = (random.uniform(7.0, 9.0), random.uniform(2.0, 3.0))
    blockade = HiddenBlockade("rubble", ((end[0], 1.0), end), 10.0)
    start, goal = random.uniform([[3.0, 1.4], [11.0, 1.4]], [[6.0, 2.0], [14.0, 2.0]])
    hall = Hall(tmp_path, [tuple(start)], [tuple(goal)], blockades=(blockade,))
    assert hall.drive(40.0) is not None
    assert hall.world.contacts.wall == 0


CAR = RobotType("car", beams=72, drive="ackermann", turning_radius_m=0.9)


@pytest.mark.parametrize("goal", [(12.0, 2.5), (1.6, 2.5), (6.0, 3.4), (5.0, 1.6)])
def test_a_car_arrives_and_never_turns_tighter_than_it_can(tmp_path: Path, goal: Point) -> None:
    hall = Hall(tmp_path, [(6.0, 2.5)], [goal], CAR)
    assert hall.drive(60.0) is not None
    poses = np.array(hall.tracks[0])
    driven_m = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    turned = np.abs(np.remainder(np.diff(poses[:, 2]) + math.pi, math.tau) - math.pi)
    assert (turned <= driven_m / CAR.turning_radius_m + 1e-6).all()
    assert driven_m.sum() > 0.2
    assert hall.world.contacts.wall == 0


@pytest.mark.parametrize("seed", range(3))
def test_cars_pass_one_another(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    y = random.uniform(1.6, 3.4, size=4)
    starts, goals = [(3.0, y[0]), (12.0, y[1])], [(12.0, y[2]), (3.0, y[3])]
    hall = Hall(tmp_path, starts, goals, CAR)
    assert hall.drive(90.0) is not None
    assert hall.world.contacts.robot == hall.world.contacts.wall == 0


def test_a_robot_that_only_a_wall_holds_leaves_it(tmp_path: Path) -> None:
    hall = Hall(tmp_path, [(1.31, 1.5)], [(1.31, 1.5)])
    (robot,) = hall.robots
    robot.goals, robot.route = [(12.0, 2.5)], []
    assert hall.driving.leave_wall(robot, hall.robots, 0.0)
    for _ in range(40):
        hall.driving.drive(hall.robots, 0.5, STEP_S)
        hall.world.step(STEP_S)
        robot.x, robot.y, robot.heading_rad = hall.world.pose(robot.id)
    assert robot.x - 1.0 > robot.kind.radius_m + MARGIN_M
    assert hall.world.contacts.wall == 0
    robot.timed = []
    assert not hall.driving.leave_wall(robot, hall.robots, 2.0)
    assert robot.timed == []


def test_a_robot_beside_another_stays_with_right_of_way(tmp_path: Path) -> None:
    hall = Hall(tmp_path, [(1.31, 1.5), (2.0, 1.5)], [(12.0, 2.5), (12.0, 1.5)])
    assert not hall.driving.leave_wall(hall.robots[0], hall.robots, 0.0)
    assert hall.robots[0].timed == []
