"""Two floors with 130 m corridors: what the floor with doors does for the bare one (4.5.5).

Floor B's walls are bare and the laser reaches 30 m. A front end that trusts the scan matcher there
shortens the corridor, as in the thesis; one that knows in which direction a match tells nothing
leaves that direction to the odometry, whose own error (here 4 % too short on average) remains until
constraints to floor A at the staircases and the lift take it out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from simulator.slam.experiments.drive import Drive, Laser, OdometryNoise, Surveyor
from simulator.slam.experiments.floors import corridor_floor
from simulator.slam.experiments.statistics import mean_and_half_width, paired_p, table
from simulator.slam.front_end import FrontEndParameters, build_map
from simulator.slam.grid_front_end import GridFrontEndParameters, merge_grid_maps
from simulator.slam.localization import LocalizationParameters
from simulator.slam.robot_map import RobotMap
from simulator.slam.scan_matching import ScanMatchParameters

LENGTH_M = 130.0
_LASER = Laser(range_m=30.0)
_ODOMETRY = OdometryNoise(metre_per_metre=0.05, length_bias=-0.04)


@dataclass(frozen=True, slots=True)
class CorridorRun:
    """Relative errors of the corridor's length on floor B in one run, as shares of it."""

    trusting: float
    """scan matcher believed in every direction, no constraints to floor A"""
    careful: float
    """blind directions left to the odometry, no constraints to floor A"""
    merged: float
    """careful, and merged with floor A"""
    constraints: int


def run_once(seed: int, method: str = "pcm") -> tuple[CorridorRun, dict[str, RobotMap]]:
    """One run: both floors driven and mapped anew, then merged."""
    random = np.random.default_rng(seed)
    drives = {name: _drive(name == "B", random) for name in ("A", "B")}
    careful, trusting = _front_end(True), _front_end(False)
    floor_a = build_map("A", drives["A"].scans, careful)
    floor_b = build_map("B", drives["B"].scans, careful)
    shrunk = build_map("B", drives["B"].scans, trusting)
    parameters = replace(
        GridFrontEndParameters(
            sequence=40,
            stride=4,
            least_constraints=3,
            localization=LocalizationParameters(density_m2=40.0),
        ),
        method=method,  # type: ignore[arg-type]
    )
    merged, _ = merge_grid_maps([floor_a, floor_b], random, parameters)
    joint = merged.robot_maps.get("B", floor_b)
    result = CorridorRun(
        length_error(shrunk, drives["B"]),
        length_error(floor_b, drives["B"]),
        length_error(joint, drives["B"]),
        len(merged.edges),
    )
    maps = {"floor A": floor_a, "B, scan matcher trusted": shrunk, "B": floor_b, "B merged": joint}
    return result, maps


def _drive(featureless: bool, random: np.random.Generator) -> Drive:
    grid, stops, _ = corridor_floor(featureless, length_m=LENGTH_M)
    surveyor = Surveyor(grid)
    # Out of step with any regular structure, and never twice the same.
    shifted = [(x + random.uniform(-0.2, 0.2), y) for x, y in stops]
    return surveyor.drive(surveyor.path(shifted), _LASER, _ODOMETRY, random)


def _front_end(careful: bool) -> FrontEndParameters:
    return FrontEndParameters(
        node_distance_m=0.4, loops=None, matching=ScanMatchParameters(debias=careful)
    )


def length_error(robot_map: RobotMap, drive: Drive) -> float:
    """Signed error of the distance between the westernmost and the easternmost node, a share."""
    places = {scan.time_s: place for place, scan in enumerate(drive.scans)}
    keys = sorted(robot_map.scans)
    truth = np.array([drive.truth[places[robot_map.scans[key].time_s]] for key in keys])
    west, east = int(np.argmin(truth[:, 0])), int(np.argmax(truth[:, 0]))
    poses = robot_map.graph.poses
    estimated = float(np.hypot(*(poses[keys[east]] - poses[keys[west]])[:2]))
    true = float(np.hypot(*(truth[east] - truth[west])[:2]))
    return estimated / true - 1.0


def report(runs: Sequence[CorridorRun]) -> str:
    """Mean absolute errors with 95 % intervals, and the paired test."""
    arms = {
        "scan matcher trusted, alone": [abs(run.trusting) for run in runs],
        "blind directions to odometry, alone": [abs(run.careful) for run in runs],
        "blind directions to odometry, merged": [abs(run.merged) for run in runs],
    }
    rows = []
    for name, values in arms.items():
        mean, half = mean_and_half_width(values)
        rows.append([name, f"{100 * mean:.2f} ± {100 * half:.2f} %", f"{LENGTH_M * mean:.2f} m"])
    rows.append(["thesis, alone", "14.2 %", "18.5 m"])
    rows.append(["thesis, merged", "5.8 %", "7.5 m"])
    p = paired_p(
        arms["blind directions to odometry, alone"], arms["blind directions to odometry, merged"]
    )
    constraints = np.mean([run.constraints for run in runs])
    return (
        table(["floor B", "error of the corridor's length", "of 130 m"], rows)
        + f"\n\n{len(runs)} runs, {constraints:.1f} constraints a run; merged against alone: "
        f"p = {p:.2g} (paired t-test)"
    )
