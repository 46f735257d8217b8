import math

import numpy as np

from simulator.vegetation.scores import Scores


def test_the_thesis_confusion_matrix() -> None:
    """Table 6.1: recall 99.6 %, precision 99.9 %."""
    scores = Scores(36_300, 4, 138, 28_745)
    assert round(100 * scores.recall, 1) == 99.6
    assert scores.precision > 0.9998
    assert scores.total == 36_304 + 28_883


def test_counts_and_sums() -> None:
    predicted = np.array([True, True, False, False, True])
    truth = np.array([True, False, True, False, True])
    scores = Scores.of(predicted, truth)
    assert scores == Scores(2, 1, 1, 1)
    assert (scores + scores).accuracy == scores.accuracy == 0.6


def test_nothing_to_score_is_not_a_number() -> None:
    nothing = Scores(0, 0, 0, 0)
    assert math.isnan(nothing.precision)
    assert math.isnan(nothing.recall)
    assert math.isnan(nothing.accuracy)
