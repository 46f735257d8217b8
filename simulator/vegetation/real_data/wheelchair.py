"""Vibration of a wheelchair: six axes at 200 Hz (McConkey, "Wheelchair terrain classification").

The files hold time in seconds, whatever their header says. There is no odometry: whether the chair
moves is told from the vibration itself.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

RATE_HZ = 200.0
_NAME = re.compile(r"Middle_([A-Z][a-z]+?)(Power)?Straight(\d?)\.csv")


@dataclass(frozen=True)
class WheelchairRun:
    """One straight run over one kind of ground."""

    name: str
    terrain: str
    powered: bool
    """Driven by its motors, not pushed."""
    samples: NDArray[np.float64]
    """`(n, 6)` at `RATE_HZ`: acceleration x, y, z [m/s^2], angular rate x, y, z [rad/s]."""


def read_wheelchair(folder: Path) -> list[WheelchairRun]:
    """All runs of a folder, sorted by name."""
    runs = []
    for path in sorted(folder.glob("Middle_*.csv*")):
        match = _NAME.match(path.name)
        if match is None:
            continue
        table = np.genfromtxt(path, delimiter=",", skip_header=1, usecols=range(7))
        table = table[np.isfinite(table).all(axis=1)]
        at_s = np.arange(table[0, 6], table[-1, 6], 1 / RATE_HZ)
        samples = np.column_stack([np.interp(at_s, table[:, 6], table[:, k]) for k in range(6)])
        name = path.name.split(".")[0].removeprefix("Middle_")
        runs.append(WheelchairRun(name, match[1], match[2] is not None, samples))
    return runs
