"""Linear discriminant analysis to one dimension, then a Gaussian for each class (section 6.8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit


@dataclass(frozen=True)
class LdaClassifier:
    """A projection and two Gaussians; a few multiplications a measurement."""

    projection: NDArray[np.float64]
    """W `(d,)` of eq. 6.24."""
    means: tuple[float, float]
    """Of the projected samples without and with vegetation."""
    deviations: tuple[float, float]

    KIND = "lda"

    def vegetation_probability(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        """P(vegetation) `(n,)` for features `(n, d)`, uniform prior (eq. 6.26)."""
        return np.asarray(expit(self.log_odds(features)))

    def log_odds(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        """ln p(x | vegetation) - ln p(x | street), a polynomial of the projected measurement."""
        (m0, m1), (s0, s1) = self.means, self.deviations
        v = features @ self.projection
        quadratic = 0.5 / s0**2 - 0.5 / s1**2
        linear = m1 / s1**2 - m0 / s0**2
        constant = 0.5 * (m0 / s0) ** 2 - 0.5 * (m1 / s1) ** 2 + np.log(s0 / s1)
        return np.asarray((quadratic * v + linear) * v + constant)

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """All that makes up the classifier."""
        gaussians = np.array([*self.means, *self.deviations])
        return {"projection": self.projection, "gaussians": gaussians}

    @staticmethod
    def from_arrays(arrays: dict[str, NDArray[np.float64]]) -> LdaClassifier:
        """The reverse of `arrays`."""
        m0, m1, s0, s1 = arrays["gaussians"].tolist()
        return LdaClassifier(arrays["projection"], (m0, m1), (s0, s1))


def train_lda(features: NDArray[np.float64], vegetation: NDArray[np.bool_]) -> LdaClassifier:
    """Trains on features `(n, d)` with labels `(n,)`.

    Raises:
        ValueError: one class has fewer than two samples, or a feature follows from the others.
    """
    from sklearn.discriminant_analysis import LinearDiscriminantAnalysis

    y = np.asarray(vegetation, dtype=np.bool_)
    if min(y.sum(), (~y).sum()) < 2:
        raise ValueError("training needs samples of both classes; one has fewer than two")
    analysis = LinearDiscriminantAnalysis(solver="eigen", n_components=1, priors=[0.5, 0.5])
    try:
        fitted = analysis.fit(features, y)
    except np.linalg.LinAlgError:
        raise ValueError(
            "the features are linearly dependent, one may be constant: leave it out"
        ) from None
    projection = np.asarray(fitted.scalings_[:, 0], dtype=np.float64)
    projected = features @ projection
    deviations = [max(float(projected[y == label].std()), 1e-12) for label in (False, True)]
    means = [float(projected[y == label].mean()) for label in (False, True)]
    return LdaClassifier(projection, (means[0], means[1]), (deviations[0], deviations[1]))
