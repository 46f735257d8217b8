"""Distances to segments in the plane."""

from __future__ import annotations

import math

from simulator.fleet_scenario import Point, Segment


def nearest_on_segment(position: Point, segment: Segment) -> Point:
    """The segment's point that is nearest to a position."""
    (ax, ay), (bx, by) = segment
    dx, dy = bx - ax, by - ay
    squared = dx * dx + dy * dy
    if squared == 0.0:
        return segment[0]
    ratio = max(0.0, min(1.0, ((position[0] - ax) * dx + (position[1] - ay) * dy) / squared))
    return (ax + ratio * dx, ay + ratio * dy)


def cross(first: Segment, second: Segment) -> bool:
    """Whether two segments cross, each ending on both sides of the other."""
    return (
        _side(first, second[0]) * _side(first, second[1]) < 0
        and _side(second, first[0]) * _side(second, first[1]) < 0
    )


def segment_distance(first: Segment, second: Segment) -> float:
    """Distance between two segments, zero where they cross [m]."""
    if cross(first, second):
        return 0.0
    return min(
        *(math.dist(p, nearest_on_segment(p, second)) for p in first),
        *(math.dist(p, nearest_on_segment(p, first)) for p in second),
    )


def _side(segment: Segment, p: Point) -> float:
    (ax, ay), (bx, by) = segment
    return (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax)
