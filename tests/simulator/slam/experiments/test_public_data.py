from pathlib import Path

import pytest

from simulator.slam.experiments.public_data import mrclam, pose_graphs

DATA = Path(__file__).parents[5] / "shared" / "data"


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
def test_pose_graphs_are_reported_beside_their_reference() -> None:
    text = pose_graphs(DATA / "posegraphs")
    for name in ("intel.g2o", "csail.g2o", "manhattanOlson3500.g2o"):
        line = next(line for line in text.splitlines() if name in line)
        apart = float(line.split("|")[7].strip(" %"))
        assert abs(apart) < 1.0


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
def test_five_real_robots_are_aligned_without_identities() -> None:
    text = mrclam(DATA / "mrclam" / "D6")
    assert "10 of 10 motions" in text
    assert ", 0 wrongly" in text
