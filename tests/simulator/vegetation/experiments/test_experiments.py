"""Every experiment runs in its small version; what needs data says so where it is absent."""

from pathlib import Path

import pytest

from simulator.vegetation.experiments import EXPERIMENTS, Setting, run

DATA = Path(__file__).parents[5] / "shared" / "data"
SIMULATED = [name for name in EXPERIMENTS if not name.startswith("real_")]


@pytest.mark.slow
@pytest.mark.parametrize("name", SIMULATED)
def test_small_version_writes_a_report_and_its_figure(name: str, tmp_path: Path) -> None:
    report = run(name, Setting(tmp_path, quick=True))
    assert report.startswith("###")
    for figure in tmp_path.glob("*.png"):
        assert f"]({figure.name})" in report
    assert list(tmp_path.glob("*.png"))


@pytest.mark.parametrize("name", ["real_remission", "real_vibration"])
def test_absent_data_is_said(name: str, tmp_path: Path) -> None:
    report = run(name, Setting(tmp_path, quick=True, data=tmp_path / "nowhere"))
    assert report.count("left out") == 2
