"""Rectangles of a mask cover it exactly."""

import re

import numpy as np
import pytest

from scenarios.report.map_figure import runs, short, thinned


@pytest.mark.parametrize("seed", range(5))
def test_runs_cover_the_mask_once(seed: int) -> None:
    mask = np.random.default_rng(seed).random((9, 13)) < 0.5
    painted = np.zeros_like(mask, dtype=int)
    for x, y, wide, high in re.findall(r"M(\d+) (\d+)h(\d+)v(\d+)h-\d+z", runs(mask, 1.0)):
        left, top = int(x), int(y)
        rows = slice(9 - top - int(high), 9 - top)
        painted[rows, left : left + int(wide)] += 1
    assert (painted == mask).all()


def test_thinning_keeps_the_ends() -> None:
    trail = tuple((float(t), 0.1 * t, 0.0) for t in range(20))
    kept = thinned(trail)
    assert kept[0] == trail[0]
    assert kept[-1] == trail[-1]
    assert len(kept) < len(trail)


@pytest.mark.parametrize(
    ("name", "expected"), [("target_12", "12"), ("explorer_2", "e2"), ("rover", "rov")]
)
def test_short_names(name: str, expected: str) -> None:
    assert short(name) == expected
