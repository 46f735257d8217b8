"""Poles and trunks in laser scans: short segments, apart from their background, round enough.

As in the feature extractors used with the Victoria Park data (Guivant, Nebot and Baiker,
"Autonomous Navigation and Map Building Using Laser Range Sensors in Outdoor Applications", Journal
of Robotic Systems 2000): a segment between two jumps of the range whose width is that of a trunk is
one; its centre lies a radius behind the nearest point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.slam.pose import Points
from simulator.slam.range_scan import RangeScan


@dataclass(frozen=True, slots=True)
class PoleParameters:
    """What counts as a pole."""

    least_diameter_m: float = 0.05
    largest_diameter_m: float = 1.2
    jump_m: float = 0.8
    """a pole stands out from what is beside it by that, on both sides"""
    least_beams: int = 2
    range_m: float = 40.0
    """poles farther away are left out"""


def detect_poles(scan: RangeScan, parameters: PoleParameters | None = None) -> Points:
    """(n, 2): centres of poles in the sensor's frame, counter-clockwise.

    Only poles nearer than both neighbours count: what lies behind something else shows but a part
    of itself.
    """
    parameters = parameters or PoleParameters()
    ranges = np.where(scan.ranges_m > 0.0, scan.ranges_m, scan.range_m).astype(np.float64)
    ranges = np.minimum(ranges, scan.range_m)
    if len(ranges) < 3:
        return np.zeros((0, 2))
    starts, ends = _segments(ranges, parameters.jump_m)
    before = ranges[np.maximum(starts - 1, 0)]
    after = ranges[np.minimum(ends, len(ranges) - 1)]
    count = ends - starts
    inner = (starts > 0) & (ends < len(ranges))
    total = np.concatenate([[0.0], np.cumsum(ranges)])
    mean = (total[ends] - total[starts]) / count
    half_width_rad = 0.5 * count * scan.bearing_step_rad
    # Seen from `mean` to the front, a disc of radius r subtends asin(r / (mean + r)).
    sine = np.sin(np.minimum(half_width_rad, 1.2))
    radius = mean * sine / (1.0 - sine)
    is_pole = (
        inner
        & (before - mean > parameters.jump_m)
        & (after - mean > parameters.jump_m)
        & (count >= parameters.least_beams)
        & (2.0 * radius >= parameters.least_diameter_m)
        & (2.0 * radius <= parameters.largest_diameter_m)
        & (mean < min(parameters.range_m, scan.range_m))
        & _is_round(ranges, starts, radius)
    )
    middle = scan.first_bearing_rad + scan.bearing_step_rad * (starts + 0.5 * (count - 1))
    front = np.minimum.reduceat(ranges, starts) if len(starts) else mean
    reach = np.minimum(mean, front + 0.25 * radius) + 0.8 * radius
    centres = np.stack([reach * np.cos(middle), reach * np.sin(middle)], axis=1)
    return np.asarray(centres[is_pole])


def _segments(
    ranges: NDArray[np.float64], jump_m: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First beams and ends (exclusive) of runs without a jump."""
    breaks = np.flatnonzero(np.abs(np.diff(ranges)) > jump_m) + 1
    edges = np.concatenate([[0], breaks, [len(ranges)]]).astype(np.intp)
    return edges[:-1], edges[1:]


def _is_round(
    ranges: NDArray[np.float64],
    starts: NDArray[np.intp],
    radius: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """(segments,): whether ranges spread no more than a disc's would."""
    low = np.minimum.reduceat(ranges, starts)
    high = np.maximum.reduceat(ranges, starts)

    return np.asarray(high - low <= radius + 0.15)
