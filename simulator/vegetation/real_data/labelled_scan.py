"""3D scans with remission and labels: RELLIS-3D and SemanticKITTI."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


class DataError(ValueError):
    """A file of a data set that cannot be read: which, and why."""


@dataclass(frozen=True)
class LabelledScan:
    """One scan in the sensor's frame; only returns, `(n,)`."""

    points_m: NDArray[np.float64]
    """`(n, 3)`"""
    remission: NDArray[np.float64]
    label: NDArray[np.uint32]

    def azimuth_rad(self) -> NDArray[np.float64]:
        """`(n,)`, -pi to pi."""
        return np.asarray(np.arctan2(self.points_m[:, 1], self.points_m[:, 0]))


RELLIS_GRASS, RELLIS_CONCRETE = 3, 23
KITTI_ROAD, KITTI_PARKING, KITTI_SIDEWALK, KITTI_TERRAIN = 40, 44, 48, 72


def read_rellis(points: Path, labels: Path) -> LabelledScan:
    """A scan of RELLIS-3D (Jiang et al., ICRA 2021): Ouster OS1-64, label ids of its ontology."""
    return _read(points, labels, least_range_m=0.5)


def read_semantic_kitti(points: Path, labels: Path) -> LabelledScan:
    """A scan of SemanticKITTI (Behley et al., ICCV 2019): HDL-64, instance numbers dropped."""
    scan = _read(points, labels, least_range_m=0.5)
    return LabelledScan(scan.points_m, scan.remission, scan.label & np.uint32(0xFFFF))


def _read(points: Path, labels: Path, least_range_m: float) -> LabelledScan:
    """x, y, z and remission as float32, labels as uint32; drops beams that did not come back.

    Raises:
        DataError: a file has the wrong length.
    """
    raw = np.fromfile(points, dtype="<f4")
    label = np.fromfile(labels, dtype="<u4")
    if len(raw) % 4 or len(raw) // 4 != len(label):
        raise DataError(
            f"{points}: {len(raw)} numbers for {len(label)} labels in {labels.name}; "
            "expected four for each"
        )
    cloud = raw.reshape(-1, 4).astype(np.float64)
    returned = np.linalg.norm(cloud[:, :3], axis=1) > least_range_m
    return LabelledScan(cloud[returned, :3], cloud[returned, 3], label[returned])
