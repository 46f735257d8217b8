from pathlib import Path

import numpy as np
import pytest

from simulator.vegetation.experiments.real_vibration import (
    STILL_M_S2,
    Run,
    left_out,
    wheelchair_recipes,
    windows_of,
)
from simulator.vegetation.real_data.wheelchair import read_wheelchair

DATA = Path(__file__).parents[5] / "shared" / "data" / "wheelchair"
BANDS = wheelchair_recipes()[3]


def synthetic_runs() -> list[Run]:
    """Grass shakes low, asphalt high; every run has a loudness of its own and begins at rest."""
    random = np.random.default_rng(1)
    runs = []
    for number in range(6):
        grass = number % 2 == 0
        white = random.normal(size=(1500, 6))
        shaped = (
            np.apply_along_axis(np.convolve, 0, white, np.ones(4) / 4, "same") if grass else white
        )
        loudness = random.uniform(2, 6) * np.where(np.arange(1500) < 400, 1e-3, 1.0)
        runs.append(Run(f"run {number}", grass, "all", shaped * loudness[:, None]))
    return runs


def test_windows_at_rest_are_left_out() -> None:
    moving = windows_of(synthetic_runs(), BANDS, STILL_M_S2, by_group=False)
    everything = windows_of(synthetic_runs(), BANDS, 0.0, by_group=False)
    assert len(everything[1]) == 6 * 22
    assert 6 * 15 <= len(moving[1]) <= 6 * 18


def test_each_run_is_told_from_the_others() -> None:
    features, vegetation, fold = windows_of(synthetic_runs(), BANDS, STILL_M_S2, by_group=False)
    assert len(np.unique(fold)) == 6
    assert np.mean(left_out(features, vegetation, fold) == vegetation) > 0.95


@pytest.mark.slow
def test_grass_against_asphalt_on_the_wheelchair() -> None:
    if not DATA.is_dir():
        pytest.skip(f"the wheelchair set is not in {DATA}")
    runs = [
        Run(r.name, r.terrain == "Grass", "", r.samples)
        for r in read_wheelchair(DATA)
        if r.terrain in ("Grass", "Asphalt")
    ]
    features, vegetation, fold = windows_of(runs, BANDS, STILL_M_S2, by_group=False)
    assert len(runs) == 8
    assert np.mean(left_out(features, vegetation, fold) == vegetation) > 0.93
