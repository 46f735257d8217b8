"""An upright frame for a depth image of a table whose camera pose nobody knows."""

import numpy as np
from numpy.typing import NDArray

from simulator.mapping.tabletop import Points, TabletopParameters, find_table


def level(
    points_m: Points, table_height_m: float = 0.75, tolerance_m: float = 0.01, seed: int = 0
) -> NDArray[np.float64]:
    """Pose of the camera `(4, 4)` in a frame with z up whose table lies at `table_height_m`.

    The table is the plane with most points, by RANSAC, and the camera is above it. The frame's
    origin lies below the camera.

    Args:
        points_m: `(n, 3)` in the camera's frame [m].

    Raises:
        ValueError: no plane with a twentieth of the points.
    """
    plane = find_table(
        points_m,
        TabletopParameters(
            plane_tolerance_m=tolerance_m,
            largest_tilt_rad=np.pi,
            smallest_table=max(3, len(points_m) // 20),
        ),
        np.random.default_rng(seed),
    )
    if plane is None:
        raise ValueError("no plane holds a twentieth of the points: this is no view of a table")
    # The camera, at the origin of its frame, lies on the upper side.
    up = plane.normal if plane.offset_m < 0 else -plane.normal
    camera_above_m = abs(plane.offset_m)
    ahead = np.eye(3)[np.abs(up).argmin()]
    x = ahead - up * (ahead @ up)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(up, x), up])
    pose[2, 3] = table_height_m + camera_above_m
    return pose
