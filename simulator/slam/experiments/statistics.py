"""Means with confidence intervals, and tables in Markdown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats


def mean_and_half_width(values: ArrayLike, confidence: float = 0.95) -> tuple[float, float]:
    """Mean, and half of its confidence interval by Student's t."""
    sample = np.asarray(values, dtype=np.float64)
    if len(sample) < 2:
        return float(sample.mean()), float("nan")
    quantile = float(stats.t.ppf(0.5 + 0.5 * confidence, len(sample) - 1))
    return float(sample.mean()), quantile * float(sample.std(ddof=1)) / float(np.sqrt(len(sample)))


def paired_p(before: ArrayLike, after: ArrayLike) -> float:
    """Two-sided p value of the paired t-test."""
    one, other = np.asarray(before, dtype=np.float64), np.asarray(after, dtype=np.float64)
    return float(stats.ttest_1samp(one - other, 0.0).pvalue)


def table(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table."""
    lines = [heads, ["---"] * len(heads), *([str(cell) for cell in row] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
