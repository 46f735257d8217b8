"""What the remission classifier is compared with: mean remission, and range differences."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class MeanRemissionClassifier:
    """The class whose mean remission is nearer, whatever range and angle (section 6.3)."""

    mean_street: float
    mean_vegetation: float

    @staticmethod
    def train(
        remission: NDArray[np.float64], vegetation: NDArray[np.bool_]
    ) -> MeanRemissionClassifier:
        """Means of remissions `(n,)` over both classes."""
        return MeanRemissionClassifier(
            float(remission[~vegetation].mean()), float(remission[vegetation].mean())
        )

    def is_vegetation(self, remission: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Classes `(n,)` of remissions `(n,)`."""
        nearer = np.abs(remission - self.mean_vegetation) < np.abs(remission - self.mean_street)
        return np.asarray(nearer)


def range_difference_features(
    end_points_m: NDArray[np.float64], range_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Local roughness f_i and range of scan lines (eqs. 6.27 and 6.28).

    Args:
        end_points_m: `(lines, beams)`, the coordinate along the viewing direction in the scan
            plane; NaN where nothing came back.
        range_m: `(lines, beams)`.

    Returns:
        `(lines, beams, 2)`, NaN for the first two beams of a line and after gaps.
    """
    d = np.full_like(end_points_m, np.nan)
    d[:, 1:] = np.diff(end_points_m, axis=1)
    roughness = np.full_like(end_points_m, np.nan)
    roughness[:, 1:] = np.abs(np.diff(d, axis=1))
    return np.stack([roughness, range_m], axis=-1)
