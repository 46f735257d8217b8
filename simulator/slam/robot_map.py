"""What one robot knows after SLAM: its pose graph, the scans of the nodes, maps drawn from both."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from simulator import _core
from simulator.mapping.occupancy import OccupancyModel
from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.pose import Poses, transform
from simulator.slam.pose_graph import PoseGraph
from simulator.slam.range_scan import RangeScan


@dataclass(frozen=True, slots=True)
class RobotMap:
    """A pose graph in the robot's own frame and the scan of each node."""

    robot: str
    graph: PoseGraph
    scans: dict[int, RangeScan] = field(default_factory=dict)
    """node -> scan; nodes without a scan have no entry"""

    def with_graph(self, graph: PoseGraph) -> RobotMap:
        """The same scans from other poses."""
        return replace(self, graph=graph)

    def posed_scans(self) -> list[tuple[Poses, RangeScan]]:
        """Scans with their nodes' poses, in the order of the nodes."""
        return [(self.graph.poses[key], self.scans[key]) for key in sorted(self.scans)]


def map_with_known_poses(
    robot_maps: Sequence[RobotMap], resolution_m: float = 0.1, reach_m: float | None = None
) -> OccupancyGrid:
    """The occupancy grid of scans from corrected poses (thesis 4.2), all in one frame.

    Args:
        robot_maps: one robot's, or several in a common frame.
        resolution_m: edge of a cell.
        reach_m: parts of beams beyond count for nothing; all of them by default.

    Raises:
        ValueError: there is no scan.
    """
    posed = [entry for robot_map in robot_maps for entry in robot_map.posed_scans()]
    return grid_of_scans(posed, resolution_m, reach_m)


def grid_of_scans(
    posed: Iterable[tuple[Poses, RangeScan]],
    resolution_m: float = 0.1,
    reach_m: float | None = None,
    model: OccupancyModel | None = None,
) -> OccupancyGrid:
    """Occupancy in percent, -1 where nothing was ever seen; row 0 at the bottom."""
    posed, model = list(posed), model or OccupancyModel()
    if not posed:
        raise ValueError("a map needs at least one scan")
    ends = [transform(pose, scan.points()) for pose, scan in posed]
    at = np.concatenate([np.array([pose[:2] for pose, _ in posed]), *ends])
    low = np.floor(at.min(axis=0) / resolution_m - 5.0) * resolution_m
    columns, rows = (np.ceil((at.max(axis=0) - low) / resolution_m) + 5).astype(int)
    log_odds = _core.OccupancyMap(
        (int(rows), int(columns)),
        resolution_m,
        (float(low[0]), float(low[1])),
        model.hit,
        model.miss,
        model.limit,
    )
    for pose, scan in posed:
        limit = scan.range_m if reach_m is None else min(reach_m, scan.range_m)
        # A reading beyond the sensor's range often is no echo at all: it says nothing.
        ranges = np.where(scan.ranges_m > 1.01 * scan.range_m, 0.0, scan.ranges_m)
        ranges = np.minimum(ranges, limit).astype(np.float32)
        log_odds.insert_fan(
            (float(pose[0]), float(pose[1])),
            float(pose[2]) + scan.first_bearing_rad,
            scan.bearing_step_rad,
            ranges,
            limit,
        )
    odds = log_odds.log_odds()
    percent = np.rint(100.0 / (1.0 + np.exp(-odds))).astype(np.int8)
    cells = np.where(odds == 0.0, np.int8(-1), percent)
    return OccupancyGrid(cells, resolution_m, (float(low[0]), float(low[1])))
