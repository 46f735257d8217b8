"""CARMEN logs: reads FLASER and ROBOTLASER1 messages, writes them, raw or with corrected poses.

Montemerlo, Roy and Thrun, "Perspectives on Standardization in Mobile Robot Programming: The
Carnegie Mellon Navigation (CARMEN) Toolkit", IROS 2003. A message is a line:

    FLASER n r_1 ... r_n  x y heading  odom_x odom_y odom_heading  time host logger_time
    ROBOTLASER1 type first_bearing field_of_view step max_range accuracy remission_mode
        n r_1 ... r_n  m remission_1 ... remission_m  x y heading  robot_x robot_y robot_heading
        tv rv forward_safety side_safety turn_axis  time host logger_time

The first pose is the laser's: by odometry in raw logs, by SLAM in corrected ones. An FLASER
message does not say its bearings; as CARMEN does, 180 degrees are assumed.
"""

from __future__ import annotations

import bz2
import gzip
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TextIO, cast

import numpy as np

from simulator.slam.pose import Poses
from simulator.slam.range_scan import RangeScan


class CarmenLogError(ValueError):
    """A log that cannot be read: file, line, reason."""


def read_carmen(path: Path, range_m: float = 40.0) -> tuple[RangeScan, ...]:
    """Reads the front laser's scans; `.gz` and `.bz2` files are unpacked on the way.

    Args:
        path: the log.
        range_m: readings that long or longer met nothing (ROBOTLASER1 brings its own, which
            counts if it is shorter).

    Raises:
        CarmenLogError: a laser message is malformed, or there is none.
        OSError: the file cannot be opened.
    """
    scans = []
    with _opened(path) as lines:
        for number, line in enumerate(lines, start=1):
            tag, _, rest = line.partition(" ")
            if tag not in ("FLASER", "ROBOTLASER1"):
                continue
            try:
                read = _flaser if tag == "FLASER" else _robot_laser
                scans.append(read(rest.split(), range_m))
            except (ValueError, IndexError) as error:
                raise CarmenLogError(
                    f"{path}:{number}: {tag} message is malformed ({error}); is the line cut off?"
                ) from None
    if not scans:
        raise CarmenLogError(f"{path}: no FLASER or ROBOTLASER1 message; is it a CARMEN log?")
    return tuple(scans)


def _opened(path: Path) -> TextIO:
    if path.suffix == ".gz":
        return cast(TextIO, gzip.open(path, "rt", encoding="utf-8"))
    if path.suffix == ".bz2":
        return cast(TextIO, bz2.open(path, "rt", encoding="utf-8"))
    return path.open(encoding="utf-8")


def _flaser(words: list[str], range_m: float) -> RangeScan:
    beams = int(words[0])
    ranges = np.array(words[1 : beams + 1], dtype=np.float32)
    rest = words[beams + 1 :]
    _at_least(len(rest), 7)
    first, step = _flaser_bearings(beams)
    pose = np.array(rest[:3], dtype=np.float64)
    return RangeScan(float(rest[6]), ranges, first, step, range_m, pose)


def _flaser_bearings(beams: int) -> tuple[float, float]:
    """First bearing and step [rad]: 181 and 361 beams include both ends of the half circle."""
    step = math.pi / (beams - 1 if beams % 2 else beams)
    return -math.pi / 2.0, step


def _robot_laser(words: list[str], range_m: float) -> RangeScan:
    first, step, reach = float(words[1]), float(words[3]), float(words[4])
    beams = int(words[7])
    ranges = np.array(words[8 : beams + 8], dtype=np.float32)
    remissions = int(words[beams + 8])
    rest = words[beams + 9 + remissions :]
    _at_least(len(rest), 12)
    pose = np.array(rest[:3], dtype=np.float64)
    return RangeScan(float(rest[11]), ranges, first, step, min(range_m, reach), pose)


def _at_least(found: int, needed: int) -> None:
    if found < needed:
        raise ValueError(f"{needed - found} columns are missing")


def write_carmen(scans: Sequence[RangeScan], path: Path, poses: Poses | None = None) -> None:
    """Writes a log that reads back to the same scans, packed if the name ends in `.gz`.

    Args:
        scans: in the order of their times.
        path: where to.
        poses: (n, 3) corrected poses of the laser, instead of the odometry's.
    """
    corrected = poses if poses is not None else np.array([scan.odometry for scan in scans])
    lines = (_line(scan, pose) for scan, pose in zip(scans, corrected, strict=True))
    if path.suffix == ".gz":
        with gzip.open(path, "wt", encoding="utf-8") as file:
            _write(cast(TextIO, file), lines)
    else:
        with path.open("w", encoding="utf-8") as file:
            _write(cast(TextIO, file), lines)


def _write(file: TextIO, lines: Iterable[str]) -> None:
    file.writelines(line + "\n" for line in lines)


def _line(scan: RangeScan, pose: Poses) -> str:
    beams = len(scan.ranges_m)
    ranges = " ".join(f"{value:.9g}" for value in scan.ranges_m)
    laser = " ".join(repr(float(value)) for value in pose)
    odometry = " ".join(repr(float(value)) for value in scan.odometry)
    stamp = f"{scan.time_s!r} marsupial {scan.time_s!r}"
    first, step = _flaser_bearings(beams)
    if scan.first_bearing_rad == first and scan.bearing_step_rad == step:
        return f"FLASER {beams} {ranges} {laser} {odometry} {stamp}"
    view = scan.bearing_step_rad * (beams - 1)
    head = (
        f"0 {scan.first_bearing_rad!r} {view!r} {scan.bearing_step_rad!r} {scan.range_m!r} 0.01 0"
    )
    return f"ROBOTLASER1 {head} {beams} {ranges} 0 {laser} {odometry} 0 0 0 0 0 {stamp}"
