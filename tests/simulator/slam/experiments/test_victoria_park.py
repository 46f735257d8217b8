import numpy as np
import pytest

from simulator.slam.experiments.victoria_park import (
    park,
    precision_and_recall,
    report,
    snapshots,
    trials,
)


@pytest.mark.parametrize("method", ["ransac", "pcm"])
def test_no_wrong_alignment_is_accepted_and_right_ones_are_accurate(method: str) -> None:
    random = np.random.default_rng(1)
    trunks = park(random)
    drivers = [snapshots(trunks, random, 40) for _ in range(4)]
    done = list(trials(drivers, random, method))  # type: ignore[arg-type]
    precision, recall = precision_and_recall(done)
    assert precision == 1.0
    assert recall > 0.8
    accurate = [trial for trial in done if trial.accepted and trial.shared >= 50]
    # Thesis: 0.3 m at 50 to 59 shared landmarks.
    assert all(trial.error_m < 0.3 for trial in accurate)
    assert "precision 1.0000" in report({method: done})
