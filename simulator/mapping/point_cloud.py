"""Reads point clouds: PCD (ASCII, binary, compressed), PLY, plain text, and OctoMap's scan logs.

Points are metres, arrays of shape `(n, 3)`; what is not finite is dropped.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from pypcd4.pypcd4 import PointCloud
from scipy.spatial.transform import Rotation


class PointCloudError(ValueError):
    """A file that holds no readable point cloud; the message names it and says why."""


@dataclass(frozen=True, slots=True)
class Scan:
    """One measurement: end points of beams and the pose of the sensor."""

    points_m: NDArray[np.float32]
    """End points `(n, 3)` in the sensor's frame."""
    origin_m: NDArray[np.float64]
    """Position of the sensor `(3,)` in the map frame."""
    rotation: Rotation
    """Orientation of the sensor in the map frame."""

    def in_map_frame(self) -> NDArray[np.float32]:
        """End points `(n, 3)` in the map frame [m]."""
        turned = self.rotation.apply(self.points_m.astype(np.float64)) + self.origin_m
        return np.asarray(turned, dtype=np.float32)


def read_points(path: Path | str) -> NDArray[np.float32]:
    """The points `(n, 3)` [m] of a `.pcd`, `.ply`, `.xyz`, `.txt` or `.dat` file.

    Text may be packed as `.dat.bz2` or `.dat.gz`.

    Raises:
        PointCloudError: for another ending or a file that cannot be read.
    """
    path = Path(path)
    try:
        packed = path.suffix.lower() in (".bz2", ".gz")
        match Path(path.stem if packed else path.name).suffix.lower():
            case ".pcd":
                points = PointCloud.from_path(path).numpy(("x", "y", "z"))
            case ".ply":
                scene = trimesh.load_scene(path, process=False)
                points = np.concatenate(
                    [np.asarray(part.vertices) for part in scene.geometry.values()]
                )
            case ".xyz" | ".txt" | ".dat":
                points = np.loadtxt(path, usecols=(0, 1, 2), ndmin=2)
            case suffix:
                raise PointCloudError(
                    f"{path}: points are read from .pcd, .ply, .xyz, .txt and .dat files, "
                    f"not {suffix or 'a file without ending'}"
                )
    except (OSError, KeyError, IndexError, TypeError, struct.error) as fault:
        raise PointCloudError(f"{path}: {fault}") from None
    except ValueError as fault:
        if isinstance(fault, PointCloudError):
            raise
        raise PointCloudError(f"{path}: {fault}") from None
    return _finite(points)


def read_labels(path: Path | str) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Points `(n, 3)` [m] and labels `(n,)` of a labelled `.pcd` file.

    Raises:
        PointCloudError: if the file has no field `label`.
    """
    cloud = PointCloud.from_path(Path(path))
    if "label" not in cloud.fields:
        raise PointCloudError(f"{path}: has the fields {', '.join(cloud.fields)}, but no label")
    points = np.asarray(cloud.numpy(("x", "y", "z")), dtype=np.float32)
    labels = np.asarray(cloud.numpy(("label",)), dtype=np.int64)[:, 0]
    known = np.isfinite(points).all(axis=1)
    return points[known], labels[known]


def read_scan_log(path: Path | str) -> list[Scan]:
    """The scans of an OctoMap scan log: binary `.graph` or text `.log` (lines `NODE x y z roll
    pitch yaw`).

    Raises:
        PointCloudError: says at which byte or line the file is broken.
    """
    path = Path(path)
    if path.suffix == ".log":
        return _read_text_log(path)
    return _read_graph(path)


def _read_graph(path: Path) -> list[Scan]:
    content = path.read_bytes()
    at = 0

    def take(layout: str) -> tuple[float, ...]:
        nonlocal at
        size = struct.calcsize(layout)
        if at + size > len(content):
            raise PointCloudError(f"{path}: ends at byte {len(content)} in the middle of a scan")
        values: tuple[float, ...] = struct.unpack_from(layout, content, at)
        at += size
        return values

    # A vector is a count and that many doubles.
    vector = np.dtype([("count", "<u4"), ("xyz", "<f8", 3)])
    scans = []
    for _ in range(int(take("<I")[0])):
        count = int(take("<I")[0])
        if at + count * vector.itemsize > len(content):
            raise PointCloudError(f"{path}: a scan of {count} points does not fit into the file")
        points = np.frombuffer(content, vector, count, at)["xyz"]
        at += count * vector.itemsize
        _, x, y, z, _, qw, qx, qy, qz = take("<I3dI4d")
        take("<I")
        rotation = Rotation.from_quat([qx, qy, qz, qw])
        scans.append(Scan(_finite(points), np.array([x, y, z]), rotation))
    return scans


def _read_text_log(path: Path) -> list[Scan]:
    poses: list[list[float]] = []
    points: list[list[list[float]]] = []
    with path.open(encoding="utf-8") as lines:
        for number, line in enumerate(lines, start=1):
            words = line.split()
            if not words or words[0].startswith("#"):
                continue
            try:
                if words[0] == "NODE":
                    poses.append([float(word) for word in words[1:7]])
                    points.append([])
                else:
                    points[-1].append([float(word) for word in words[:3]])
            except (ValueError, IndexError):
                raise PointCloudError(
                    f"{path}:{number}: expected `NODE x y z roll pitch yaw` or `x y z`, "
                    f"found {line.strip()!r}"
                ) from None
    return [
        Scan(
            _finite(np.array(cloud, dtype=np.float64).reshape(-1, 3)),
            np.array(pose[:3]),
            Rotation.from_euler("xyz", pose[3:6]),
        )
        for pose, cloud in zip(poses, points, strict=True)
    ]


def _finite(points: NDArray[np.generic]) -> NDArray[np.float32]:
    points = np.asarray(points, dtype=np.float32)
    return np.ascontiguousarray(points[np.isfinite(points).all(axis=1)])
