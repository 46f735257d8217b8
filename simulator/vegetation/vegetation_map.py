"""A 3D map that holds, beside occupancy, the probability of vegetation (section 6.5)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import expit, logit

from simulator.mapping.octree import OctreeMap, SensorModel

Array = NDArray[np.float64]
_CHANNEL = "vegetation"


@dataclass(frozen=True, slots=True)
class VegetationMapParameters:
    """Cells and evidence of a vegetation map."""

    resolution_m: float = 0.1
    prior: float = 0.5
    """P(v) of a voxel before it is measured (eq. 6.18)."""
    most_certain: float = 0.95
    """No single measurement counts as more certain than this, however sure the classifier is."""
    clamp: float = 6.0
    """Largest absolute log odds of a voxel, so that the map can change its mind."""


class VegetationMap:
    """An octree of occupancy with a channel of vegetation log odds."""

    def __init__(self, parameters: VegetationMapParameters | None = None) -> None:
        self.parameters = parameters or VegetationMapParameters()
        clamp = self.parameters.clamp
        self.octree = OctreeMap(self.parameters.resolution_m)
        self.octree.add_channel(
            _CHANNEL, SensorModel(hit=1.0, miss=-1.0, lowest=-clamp, highest=clamp)
        )

    def insert(self, points_m: Array, sensor_m: Array, probability: Array) -> None:
        """Adds end points `(n, 3)` with the scanner's position `(3,)` or `(n, 3)` and P `(n,)`.

        Occupancy is updated scan line by scan line; where P(vegetation) is NaN only that is. The
        recursive update of eq. 6.18 is a sum of log odds less the prior's.
        """
        origins = np.broadcast_to(sensor_m, points_m.shape)
        change = np.flatnonzero((np.diff(origins, axis=0) != 0).any(axis=1)) + 1
        starts = [0, *change.tolist(), len(points_m)]
        for begin, end in pairwise(starts):
            self.octree.insert_scan(origins[begin], points_m[begin:end])
        limit = self.parameters.most_certain
        evidence = logit(np.clip(probability, 1.0 - limit, limit)) - logit(self.parameters.prior)
        self.octree.add_to_channel(_CHANNEL, points_m, evidence)

    def probability(self, points_m: ArrayLike) -> Array:
        """P(vegetation) `(n,)` of the voxels at points `(n, 3)`; NaN where never measured."""
        return np.asarray(expit(self.log_odds(points_m) + logit(self.parameters.prior)))

    def log_odds(self, points_m: ArrayLike) -> Array:
        """Evidence for vegetation `(n,)`, without the prior; NaN where it was never measured."""
        return self.octree.channel_log_odds(_CHANNEL, points_m)

    def surface(
        self, bounds_m: tuple[ArrayLike, ArrayLike] | None = None
    ) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Voxels that beams ended in, in a box if one is given.

        Returns centres `(n, 3)`, evidence for vegetation `(n,)`, and whether they are occupied.
        Beams that graze the ground free voxels of it that others have hit: classified voxels are
        surface all the same.
        """
        centres, occupancy = self.octree.known_voxels(bounds_m)
        evidence = self.log_odds(centres)
        occupied = occupancy >= 0
        hit = occupied | np.isfinite(evidence)
        return centres[hit], evidence[hit], np.asarray(occupied[hit])
