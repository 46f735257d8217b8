from dataclasses import replace

import pytest

from simulator.slam.experiments.corridors import report, run_once


@pytest.mark.slow
def test_merging_with_the_other_floor_corrects_the_corridor() -> None:
    run, _ = run_once(0)
    assert run.constraints >= 3
    assert abs(run.merged) < 0.02 < abs(run.careful)
    assert "5.8 %" in report([run, replace(run, merged=0.5 * run.merged)])
