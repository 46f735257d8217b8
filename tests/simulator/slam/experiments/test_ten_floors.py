from dataclasses import replace

import numpy as np
import pytest

from simulator.slam.experiments.ten_floors import report, run_once


@pytest.mark.slow
def test_floors_are_aligned_with_the_first() -> None:
    run, _, _ = run_once(0, floors=(0, 1, 2))
    assert run.aligned >= 1
    assert run.wrong == 0
    assert np.mean(run.merged_m) < 0.6 * np.mean(run.odometry_m)
    assert "95 %" in report([run, replace(run, merged_rad=tuple(0.5 * e for e in run.merged_rad))])
