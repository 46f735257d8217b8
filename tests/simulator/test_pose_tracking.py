"""Odometry that drifts, and what scans against the map make of it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from simulator._core import Floor
from simulator.driving import Driving
from simulator.fleet_client import FleetClient
from simulator.fleet_scenario import Noise
from simulator.knowledge import Knowledge
from simulator.navigation import Navigation
from simulator.occupancy_grid import OccupancyGrid, read_map_server
from simulator.pose_tracking import PoseTracking, drifts, wall_surfaces
from simulator.robot import Robot
from simulator.sensors import RangeFinder
from simulator.simulation import Simulation, SimulationResult
from simulator.world import World
from tests.simulator.dispatcher import Dispatcher
from tests.simulator.floors import EXPLORER, TWO_ROOMS, two_rooms, write_floor

NOISE = Noise(laser_range_m=0.01, odometry_m=0.05, odometry_rad=0.05, odometry_rad_per_m=0.02)


def test_walls_become_points_with_their_normals() -> None:
    cells = np.zeros((3, 4), dtype=np.int8)
    cells[1, 1:3] = 100
    surfaces = wall_surfaces(OccupancyGrid(cells, 0.5, (1.0, 2.0)))
    border_m = 2 * (2.0 + 1.5)
    assert len(surfaces.points_m) == round((2 * 1.0 + 2 * 0.5 + border_m) / 0.05)
    inside = (np.abs(surfaces.points_m - (2.0, 2.75)) < (0.6, 0.3)).all(axis=1)
    lower = inside & np.isclose(surfaces.points_m[:, 1], 2.5)
    assert surfaces.points_m[lower][:, 0].min() == pytest.approx(1.525)
    assert (surfaces.normals[lower] == [0.0, 1.0]).all()


def drifted(steps: int, step_m: float, seed: int) -> float:
    """By how much the odometry alone is off after driving straight on."""
    tracking = PoseTracking(Noise(odometry_m=0.1), seed)
    robot = Robot("robot", EXPLORER, 0.0, 0.0, 0.5)
    for k in range(1, steps + 1):
        far = k * step_m
        tracking.move(robot, (far * math.cos(0.5), far * math.sin(0.5), 0.5))
    assert robot.truth[0] == pytest.approx(steps * step_m * math.cos(0.5))
    return math.dist(robot.position, robot.truth[:2])


@pytest.mark.parametrize("step_m", [0.05, 0.5])
def test_drift_grows_with_the_root_of_the_way_whatever_the_steps(step_m: float) -> None:
    def root_mean_square(way_m: float) -> float:
        errors = [drifted(round(way_m / step_m), step_m, seed) for seed in range(300)]
        return math.sqrt(np.mean(np.square(errors)))

    # Two directions, each with 0.1 m after a metre.
    assert root_mean_square(1.0) == pytest.approx(0.1 * math.sqrt(2.0), rel=0.1)
    assert root_mean_square(4.0) == pytest.approx(0.2 * math.sqrt(2.0), rel=0.1)


@pytest.mark.parametrize("seed", range(10))
def test_a_scan_against_the_map_mends_a_belief(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    grid = read_map_server(write_floor(tmp_path, TWO_ROOMS))
    floor = Floor(grid.walls(), grid.resolution_m, grid.origin_m)
    tracking = PoseTracking(Noise(odometry_m=0.2, odometry_rad=0.1), seed)
    x, y, heading = (*random.uniform([2.0, 2.0], [8.0, 5.0]), random.uniform(-3.0, 3.0))
    robot = Robot("robot", EXPLORER, x, y, heading)
    finder = RangeFinder(floor, 0.01)
    tracking.correct(robot, finder.scan(robot, [], [], 0.0, random), grid)
    tracking.move(robot, (x + 0.4, y, heading + 0.5))
    before = math.dist(robot.position, robot.truth[:2])
    tracking.correct(robot, finder.scan(robot, [], [], 1.0, random), grid)
    tracking.note(robot)
    ((off_m, off_rad),) = tracking.errors["robot"]
    assert before > 0.03
    assert off_m < 0.03
    assert off_rad < 0.02


def test_a_bare_wall_tells_nothing_of_the_way_along_it() -> None:
    """A corridor without a door in sight: the odometry decides along it, the walls across."""
    cells = np.zeros((20, 300), dtype=np.int8)
    cells[[0, -1]] = 100
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    floor = Floor(grid.walls(), grid.resolution_m, grid.origin_m)
    tracking = PoseTracking(Noise(odometry_m=0.1), 0)
    robot = Robot("robot", EXPLORER, 15.0, 1.0, 0.0)
    tracking.correct(robot, RangeFinder(floor).scan(robot, [], [], 0.0, random()), grid)
    tracking.move(robot, (16.0, 1.0, 0.0))
    along, across = robot.x - 16.0, robot.y - 1.0
    assert abs(along) > 0.005
    assert abs(across) > 0.005
    tracking.correct(robot, RangeFinder(floor).scan(robot, [], [], 1.0, random()), grid)
    assert robot.x - 16.0 == pytest.approx(along, abs=0.02)
    assert abs(robot.y - 1.0) < 0.01


def random() -> np.random.Generator:
    return np.random.default_rng(0)


def mission(folder: Path, noise: Noise, seed: int = 0) -> SimulationResult:
    scenario = replace(two_rooms(folder, seed=seed), noise=noise, time_limit_s=300.0)
    simulation = Simulation(scenario, FleetClient(Dispatcher()))
    for _ in simulation.run():
        pass
    assert simulation.result is not None
    return simulation.result


@pytest.mark.parametrize("seed", range(3))
def test_a_mission_with_drift_completes_and_touches_nothing(tmp_path: Path, seed: int) -> None:
    result = mission(tmp_path, NOISE, seed)
    assert result.outcome == "completed"
    contacts = result.contacts
    assert (contacts.wall, contacts.robot, contacts.blockade, contacts.crossings) == (0, 0, 0, 0)
    errors = np.concatenate(list(result.pose_errors.values()))
    assert 0.0 < errors[:, 0].mean() < 0.1
    # Tracks are the truth: whoever visits a target is near it, if not quite where it believes.
    track = result.tracks["explorer_1"]
    at = track[np.searchsorted(track[:, 0], result.visited["far"])]
    assert math.dist(at[1:3], (17.0, 2.0)) < 0.25 + 0.3


def test_drift_repeats_with_its_seed(tmp_path: Path) -> None:
    first, second, other = (mission(tmp_path, NOISE, seed) for seed in (4, 4, 5))
    assert all(np.array_equal(first.tracks[r], second.tracks[r]) for r in first.tracks)
    assert not np.array_equal(first.pose_errors["explorer_1"], other.pose_errors["explorer_1"])


def test_without_drift_beliefs_are_the_truth(tmp_path: Path) -> None:
    assert not drifts(Noise(laser_range_m=0.1))
    result = mission(tmp_path, Noise())
    assert result.pose_errors == {}


def test_robots_drive_by_what_they_believe(tmp_path: Path) -> None:
    """A body that is aside of its belief ends as far aside of the goal."""
    grid = read_map_server(write_floor(tmp_path, TWO_ROOMS))
    world, known = World(grid, ()), Knowledge(Navigation(grid))
    robot = Robot("robot", EXPLORER, 2.0, 2.0, 0.0, body=(2.0, 2.3, 0.0))
    world.place("robot", EXPLORER.radius_m, (2.0, 2.3, 0.0))
    driving = Driving(world, {"robot": known}, known.navigation.walls)
    robot.follow([(2.0, 2.0), (7.0, 2.0)])
    tracking = PoseTracking(Noise(), 0)
    for step in range(200):
        driving.drive([robot], 0.05 * step, 0.05)
        world.step(0.05)
        tracking.move(robot, world.pose("robot"))
    assert robot.position == pytest.approx((7.0, 2.0), abs=0.1)
    assert world.pose("robot")[:2] == pytest.approx((7.0, 2.3), abs=0.1)
