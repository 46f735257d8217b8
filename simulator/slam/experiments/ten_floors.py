"""Ten floors of one building, aligned by localizing each in the first (4.5.4, Fig. 4.10).

Four floors with the same walls and doors and furniture of their own; floors two to four are used
three times, each time mapped on a drive of its own. Between floors the robot turns in the lift: its
heading errs by 0.2 rad (standard deviation).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from simulator.slam.experiments.drive import Laser, OdometryNoise, Surveyor
from simulator.slam.experiments.floors import office_floor
from simulator.slam.experiments.statistics import mean_and_half_width, paired_p, table
from simulator.slam.front_end import build_map
from simulator.slam.grid_front_end import GridFrontEndParameters, align_grid_maps, reference_map
from simulator.slam.merging import Alignment, merge
from simulator.slam.pose import Poses, between, compose, inverse
from simulator.slam.robot_map import RobotMap

FLOORS = (0, 1, 2, 3, 1, 2, 3, 1, 2, 3)
ROTATION_RAD = 0.2


@dataclass(frozen=True, slots=True)
class BuildingRun:
    """One repetition."""

    odometry_rad: tuple[float, ...]
    """error of each floor's heading without constraints between floors"""
    odometry_m: tuple[float, ...]
    """error of the floor's farthest node"""
    merged_rad: tuple[float, ...]
    merged_m: tuple[float, ...]
    aligned: int
    """floors for which enough constraints were found"""
    wrong: int
    """accepted alignments that are wrong by more than a metre or 0.1 rad"""


def run_once(
    seed: int, method: str = "pcm", floors: Sequence[int] = FLOORS, rooms: int = 6
) -> tuple[BuildingRun, list[RobotMap], dict[str, Poses]]:
    """Maps all floors, aligns each with the first, merges."""
    random = np.random.default_rng(seed)
    maps: list[RobotMap] = []
    frames: list[Poses] = []
    """what brings each believed floor to where it truly is"""
    for place, floor in enumerate(floors):
        robot_map, frame = _map_floor(seed, place, floor, rooms, random)
        # What the robot believes after the lift: right, but for the heading.
        believed = compose(frame, np.array([0.0, 0.0, random.normal(0.0, ROTATION_RAD)]))
        robot_map = robot_map.with_graph(robot_map.graph.moved(believed if place else frame))
        maps.append(robot_map)
        frames.append(compose(frame, inverse(believed if place else frame)))
    parameters = replace(
        GridFrontEndParameters(sequence=40, stride=6),
        method=method,  # type: ignore[arg-type]
    )
    reference = reference_map(maps[0], parameters)
    alignments: list[Alignment] = []
    wrong = 0
    for place in range(1, len(maps)):
        found = align_grid_maps(reference, maps[place], random, parameters)
        if found.alignment is not None:
            alignments.append(found.alignment)
            away = between(frames[place], found.alignment.motion)
            wrong += bool(np.hypot(away[0], away[1]) > 1.0 or abs(away[2]) > 0.1)
    joint = merge(maps, alignments, parameters.back_end)
    before = [_errors(m, m, frames[place]) for place, m in enumerate(maps)][1:]
    after = [
        _errors(joint.robot_maps.get(m.robot, m), m, frames[place]) for place, m in enumerate(maps)
    ][1:]
    run = BuildingRun(
        tuple(e[0] for e in before),
        tuple(e[1] for e in before),
        tuple(e[0] for e in after),
        tuple(e[1] for e in after),
        len(alignments),
        wrong,
    )
    return run, [joint.robot_maps.get(m.robot, m) for m in maps], dict(joint.frames)


def _map_floor(
    seed: int, place: int, floor: int, rooms: int, random: np.random.Generator
) -> tuple[RobotMap, Poses]:
    grid, stops = office_floor(106 + seed, floor, rooms)
    surveyor = Surveyor(grid)
    drive = surveyor.drive(surveyor.path(stops), Laser(range_m=25.0), OdometryNoise(), random)
    robot_map = build_map(f"floor_{place}", drive.scans)
    frame = compose(drive.truth[0], inverse(robot_map.graph.poses[0]))
    return robot_map, frame


def _errors(robot_map: RobotMap, before: RobotMap, motion: Poses) -> tuple[float, float]:
    """Error of a floor's heading [rad] and of its farthest node [m] against the truth."""
    keys = sorted(before.graph.poses)
    truth = compose(motion, np.array([before.graph.poses[key] for key in keys]))
    found = np.array([robot_map.graph.poses[key] for key in keys])
    heading = np.angle(np.mean(np.exp(1j * (found[:, 2] - truth[:, 2]))))
    apart = np.hypot(found[:, 0] - truth[:, 0], found[:, 1] - truth[:, 1])
    return float(abs(heading)), float(apart.max())


def report(runs: Sequence[BuildingRun]) -> str:
    """Mean errors over the repetitions with 95 % intervals."""
    rows = []
    for name, heading, distance in (
        (
            "without constraints between floors",
            [np.mean(run.odometry_rad) for run in runs],
            [np.mean(run.odometry_m) for run in runs],
        ),
        (
            "with constraints",
            [np.mean(run.merged_rad) for run in runs],
            [np.mean(run.merged_m) for run in runs],
        ),
    ):
        turn, turn_half = mean_and_half_width(heading)
        far, far_half = mean_and_half_width(distance)
        rows.append([name, f"{turn:.4f} ± {turn_half:.4f}", f"{far:.3f} ± {far_half:.3f}"])
    p = paired_p(
        [np.mean(run.odometry_rad) for run in runs], [np.mean(run.merged_rad) for run in runs]
    )
    floors = len(runs[0].odometry_rad)
    aligned, wrong = sum(run.aligned for run in runs), sum(run.wrong for run in runs)
    return (
        table(["alignment error of a floor", "heading [rad]", "farthest node [m]"], rows)
        + f"\n\n{len(runs)} repetitions of {floors + 1} floors, 95 % intervals; "
        f"{aligned} of {floors * len(runs)} floors aligned, {wrong} wrongly; p = {p:.2g}"
    )
