"""Vibration of a Husky A200 at 50 Hz: the Vulpi set (Vulpi et al., J. Terramechanics 2021)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

RATE_HZ = 50.0
WHEEL_BASE_M = 0.5708
"""Distance of the wheels' tracks (Clearpath's description of the A200)."""


@dataclass(frozen=True)
class HuskyRun:
    """One run over one kind of ground; samples at `RATE_HZ`."""

    name: str
    terrain: str
    samples: NDArray[np.float64]
    """`(n, 6)`: acceleration x, y, z [m/s^2], angular rate x, y, z [rad/s]."""
    forward_m_s: NDArray[np.float64]
    rotation_rad_s: NDArray[np.float64]


def read_husky(folder: Path) -> list[HuskyRun]:
    """All runs of a folder that holds a folder for each terrain, sorted by name."""
    runs = []
    for path in sorted(folder.glob("*/imu_*.csv")):
        imu = np.genfromtxt(path, delimiter=",", skip_header=1)
        wheels = np.genfromtxt(
            path.with_name(path.name.replace("imu_", "pro_")), delimiter=",", skip_header=1
        )
        at_s = np.arange(imu[0, 0], imu[-1, 0], 1 / RATE_HZ)
        rates, accelerations = imu[:, 1:4], imu[:, 4:7]
        both = np.column_stack([accelerations, rates])
        samples = np.column_stack([np.interp(at_s, imu[:, 0], both[:, k]) for k in range(6)])
        left, right = (np.interp(at_s, wheels[:, 0], wheels[:, k]) for k in (1, 2))
        name = f"{path.parent.name}/{path.stem.removeprefix('imu_')}"
        forward, rotation = (left + right) / 2, (right - left) / WHEEL_BASE_M
        runs.append(HuskyRun(name, path.parent.name, samples, forward, rotation))
    return runs
