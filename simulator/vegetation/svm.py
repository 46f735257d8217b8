"""C-SVM with an RBF kernel, grid search and Platt's probabilities (sections 6.2 and 6.3.1).

Trained by scikit-learn (LibSVM); what is kept is a handful of arrays, so that a trained classifier
can be stored without pickle and evaluated without scikit-learn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

Split = tuple[NDArray[np.intp], NDArray[np.intp]]


@dataclass(frozen=True, slots=True)
class SvmParameters:
    """How a support vector machine is trained."""

    log2_gamma: tuple[float, ...] = tuple(range(-15, 4, 2))
    """Searched kernel widths: k = exp(-gamma d^2) on standardised features, l = 1/sqrt(2 gamma).

    The thesis names the range -15..3 for log2 l; it is that of LibSVM's grid for gamma.
    """
    log2_c: tuple[float, ...] = tuple(range(-5, 16, 2))
    """Searched soft margins."""
    folds: int = 5
    search_points: int = 2000
    """Points of both classes together that the grid search uses; it is cubic in them."""
    seed: int = 0


@dataclass(frozen=True)
class SvmClassifier:
    """A trained support vector machine; `vegetation_probability` is all it does."""

    mean: NDArray[np.float64]
    """`(d,)`: subtracted from features first."""
    scale: NDArray[np.float64]
    """`(d,)`: divides features then."""
    support_vectors: NDArray[np.float64]
    """`(s, d)`, standardised."""
    weights: NDArray[np.float64]
    """`(s,)`: alpha_i y_i (eq. 6.11)."""
    bias: float
    gamma: float
    c: float
    platt: tuple[float, float]
    """A and B of eq. 6.15."""

    KIND = "svm"

    def decision(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        """f(x) `(n,)` of eq. 6.3 with the kernel of eq. 6.14 for features `(n, d)`."""
        # Single precision is plenty for a kernel value and twice as fast.
        support = self.support_vectors.astype(np.float32)
        weights = self.weights.astype(np.float32)
        squared = np.einsum("sd,sd->s", support, support)
        chunk = max(1, 2_000_000 // max(1, len(support)))
        found = np.empty(len(features), np.float64)
        for begin in range(0, len(features), chunk):
            part = (features[begin : begin + chunk] - self.mean) / self.scale
            x = part.astype(np.float32)
            distances = x @ support.T
            distances *= -2.0
            distances += squared
            distances += np.einsum("nd,nd->n", x, x)[:, None]
            distances *= np.float32(-self.gamma)
            np.exp(distances, out=distances)
            found[begin : begin + chunk] = distances @ weights + self.bias
        return found

    def vegetation_probability(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        """P(vegetation) `(n,)` by Platt's method (eq. 6.15)."""
        a, b = self.platt
        return np.asarray(expit(-(a * self.decision(features) + b)))

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """All that makes up the classifier."""
        scalars = np.array([self.bias, self.gamma, self.c, *self.platt])
        return {
            "mean": self.mean,
            "scale": self.scale,
            "support_vectors": self.support_vectors,
            "weights": self.weights,
            "scalars": scalars,
        }

    @staticmethod
    def from_arrays(arrays: dict[str, NDArray[np.float64]]) -> SvmClassifier:
        """The reverse of `arrays`."""
        bias, gamma, c, a, b = arrays["scalars"].tolist()
        return SvmClassifier(
            arrays["mean"],
            arrays["scale"],
            arrays["support_vectors"],
            arrays["weights"],
            bias,
            gamma,
            c,
            (a, b),
        )


def train_svm(
    features: NDArray[np.float64],
    vegetation: NDArray[np.bool_],
    groups: NDArray[np.int_] | None = None,
    parameters: SvmParameters | None = None,
) -> SvmClassifier:
    """Trains on features `(n, d)` with labels `(n,)`.

    `groups` `(n,)` are cross-validated as wholes: give the number of the scan or run that a sample
    comes from, because neighbouring measurements are no independent test.

    Raises:
        ValueError: one class is missing, or there are fewer groups than two.
    """
    from sklearn.calibration import CalibratedClassifierCV
    from sklearn.svm import SVC

    parameters = parameters or SvmParameters()
    mean, scale = features.mean(axis=0), features.std(axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    x, y = (features - mean) / scale, np.asarray(vegetation, dtype=np.bool_)
    if y.all() or not y.any():
        raise ValueError("training needs samples of both classes; only one is there")
    gamma, c = _search(x, y, groups, parameters)
    splits = _splits(y, groups, parameters)
    calibrated = CalibratedClassifierCV(
        SVC(C=c, gamma=gamma, cache_size=500), method="sigmoid", ensemble=False, cv=splits
    ).fit(x, y)
    fitted: Any = calibrated.calibrated_classifiers_[0]
    machine, platt = fitted.estimator, fitted.calibrators[0]
    return SvmClassifier(
        mean,
        scale,
        np.asarray(machine.support_vectors_),
        np.asarray(machine.dual_coef_[0]),
        float(machine.intercept_[0]),
        gamma,
        c,
        (float(platt.a_), float(platt.b_)),
    )


def _search(
    x: NDArray[np.float64],
    y: NDArray[np.bool_],
    groups: NDArray[np.int_] | None,
    parameters: SvmParameters,
) -> tuple[float, float]:
    """gamma and C with the best cross-validated accuracy; of equals the smoothest."""
    from sklearn.model_selection import cross_val_score
    from sklearn.svm import SVC

    grid = [(2.0**g, 2.0**c) for c in parameters.log2_c for g in parameters.log2_gamma]
    if len(grid) == 1:
        return grid[0]
    some = _subset(y, parameters)
    x, y = x[some], y[some]
    splits = _splits(y, None if groups is None else groups[some], parameters)
    best, chosen = -1.0, grid[0]
    for gamma, c in grid:
        # The iteration limit ends hopeless corners of the grid (large C on overlapping classes).
        machine = SVC(C=c, gamma=gamma, max_iter=100_000, cache_size=100)
        score = float(np.mean(_quietly(cross_val_score, machine, x, y, splits)))
        if score > best + 1e-9:
            best, chosen = score, (gamma, c)
    return chosen


def _quietly(score: Any, machine: Any, *arguments: Any) -> Any:
    import warnings

    from sklearn.exceptions import ConvergenceWarning

    x, y, splits = arguments
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        return score(machine, x, y, cv=splits)


def _subset(y: NDArray[np.bool_], parameters: SvmParameters) -> NDArray[np.intp]:
    """Indices of samples for the search, with both classes in their shares."""
    if len(y) <= parameters.search_points:
        return np.arange(len(y))
    random = np.random.default_rng(parameters.seed)
    parts = []
    for label in (False, True):
        of_class = np.flatnonzero(y == label)
        count = max(parameters.folds, round(parameters.search_points * len(of_class) / len(y)))
        parts.append(random.choice(of_class, min(count, len(of_class)), replace=False))
    return np.sort(np.concatenate(parts))


def _splits(
    y: NDArray[np.bool_], groups: NDArray[np.int_] | None, parameters: SvmParameters
) -> Sequence[Split]:
    from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold

    if groups is None:
        folds = StratifiedKFold(parameters.folds, shuffle=True, random_state=parameters.seed)
        return list(folds.split(np.zeros(len(y)), y))
    count = min(parameters.folds, len(np.unique(groups)))
    if count < 2:
        raise ValueError("cross validation needs samples of two groups (scans or runs) at least")
    grouped = StratifiedGroupKFold(count, shuffle=True, random_state=parameters.seed)
    splits = list(grouped.split(np.zeros(len(y)), y, groups))
    if all(0 < y[train].sum() < len(train) for train, _ in splits):
        return splits
    # A class that lives in one group cannot be learned from the others: split inside groups.
    folds = StratifiedKFold(parameters.folds, shuffle=True, random_state=parameters.seed)
    return list(folds.split(np.zeros(len(y)), y))
