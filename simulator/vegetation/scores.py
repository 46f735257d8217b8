"""Precision, recall and accuracy of a two-class classification; vegetation is positive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Scores:
    """A confusion matrix."""

    true_positives: int
    false_positives: int
    false_negatives: int
    true_negatives: int

    @staticmethod
    def of(predicted: NDArray[np.bool_], truth: NDArray[np.bool_]) -> Scores:
        """Counts predictions `(n,)` against the truth `(n,)`."""
        return Scores(
            int(np.sum(predicted & truth)),
            int(np.sum(predicted & ~truth)),
            int(np.sum(~predicted & truth)),
            int(np.sum(~predicted & ~truth)),
        )

    def __add__(self, other: Scores) -> Scores:
        return Scores(
            self.true_positives + other.true_positives,
            self.false_positives + other.false_positives,
            self.false_negatives + other.false_negatives,
            self.true_negatives + other.true_negatives,
        )

    @property
    def total(self) -> int:
        """Number of classifications."""
        right = self.true_positives + self.true_negatives
        return right + self.false_positives + self.false_negatives

    @property
    def precision(self) -> float:
        """Share of what was called vegetation that is; NaN if nothing was."""
        called = self.true_positives + self.false_positives
        return self.true_positives / called if called else float("nan")

    @property
    def recall(self) -> float:
        """Share of vegetation that was found; NaN if there is none."""
        present = self.true_positives + self.false_negatives
        return self.true_positives / present if present else float("nan")

    @property
    def accuracy(self) -> float:
        """Share of all that is right; NaN if nothing was classified."""
        right = self.true_positives + self.true_negatives
        return right / self.total if self.total else float("nan")
