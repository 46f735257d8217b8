"""Odometry as a measurement: the motion between two readings, and how far it may be trusted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.slam.pose import Poses, compose


@dataclass(frozen=True, slots=True)
class OdometryModel:
    """Standard deviations of a motion's parts, growing with the motion.

    After Thrun, Burgard and Fox, Probabilistic Robotics (2005), 5.4, linearised around the motion.
    """

    still_m: float = 0.01
    """of a motion of no length"""
    still_rad: float = 0.005
    metre_per_metre: float = 0.08
    metre_per_radian: float = 0.04
    radian_per_radian: float = 0.12
    radian_per_metre: float = 0.03

    def deviations(self, motion: Poses) -> NDArray[np.float64]:
        """(..., 3): of x, y [m] and heading [rad] of motions (..., 3) in the robot's frame."""
        length = np.hypot(motion[..., 0], motion[..., 1])
        turn = np.abs(motion[..., 2])
        along = self.still_m + self.metre_per_metre * length + self.metre_per_radian * turn
        heading = self.still_rad + self.radian_per_radian * turn + self.radian_per_metre * length
        return np.stack([along, along, heading], axis=-1)

    def information(self, motion: Poses) -> NDArray[np.float64]:
        """(3, 3): inverse covariance of one motion."""
        return np.diag(1.0 / self.deviations(motion) ** 2)

    def sample(self, motion: Poses, count: int, random: np.random.Generator) -> Poses:
        """(count, 3): motions that may have been meant."""
        noise = random.normal(size=(count, 3)) * self.deviations(motion)
        return compose(motion, noise)
