"""Wheelchair and Husky: vibration of real vehicles, each run left out in turn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import decimate

from simulator.vegetation.experiments import Setting
from simulator.vegetation.experiments.report import percent, table
from simulator.vegetation.real_data import husky, wheelchair
from simulator.vegetation.svm import SvmParameters, train_svm
from simulator.vegetation.vibration import band_features

Array = NDArray[np.float64]
Features = Callable[[Array], Array]
STILL_M_S2 = 0.5
"""A window shaken less than this (root of the summed variances of three axes) is no drive."""
PARAMETERS = SvmParameters(log2_gamma=(-5,), log2_c=(2,))


@dataclass(frozen=True)
class Recipe:
    """How windows are cut and described."""

    name: str
    samples: int
    features: Features
    """`(samples, 6)` to `(d,)`"""


@dataclass(frozen=True)
class Run:
    """Samples `(n, 6)` of one run."""

    name: str
    vegetation: bool
    group: str
    samples: Array


def run(setting: Setting) -> str:
    """Returns the tables; sets that are absent are named instead."""
    report = ["### Real vibration: grass against hard ground\n"]
    folder = setting.data / "wheelchair"
    if folder.is_dir():
        report.append(_wheelchair(wheelchair.read_wheelchair(folder), quick=setting.quick))
    else:
        report.append(f"The wheelchair set is not in {setting.data}: left out.\n")
    folder = setting.data / "vulpi"
    if folder.is_dir():
        report.append(_husky(husky.read_husky(folder)))
    else:
        report.append(f"The Husky set is not in {setting.data}: left out.\n")
    return "\n".join(report)


def _wheelchair(recorded: list[wheelchair.WheelchairRun], *, quick: bool) -> str:
    runs = [
        Run(r.name, r.terrain == "Grass", "motors" if r.powered else "pushed", r.samples)
        for r in recorded
    ]
    terrain = {r.name: r.terrain for r in recorded}
    pair = [r for r in runs if terrain[r.name] in ("Grass", "Asphalt")]
    recipes = wheelchair_recipes()
    rows = []
    for recipe in recipes[-2:] if quick else recipes:
        cells = [
            _accuracy(pair, recipe, still_m_s2=0.0),
            _accuracy(pair, recipe),
            _accuracy(pair, recipe, by_group=True),
            _accuracy(runs, recipe),
        ]
        rows.append([recipe.name, f"{recipe.samples / wheelchair.RATE_HZ:.2f} s", *cells])
    heads = [
        "features",
        "window",
        "grass/asphalt, standing included",
        "grass/asphalt, moving",
        "the same, trained on the other drive",
        "grass/all four others, moving (balanced)",
    ]
    return (
        "**Wheelchair**, each run left out in turn. The recordings begin and end with the chair "
        f"standing; *moving* leaves out windows shaken less than {STILL_M_S2} m/s², without "
        "looking at their label. *Other drive*: trained on pushed runs and tested on motor-driven "
        "ones, and the reverse.\n\n" + table(heads, rows)
    )


def _husky(recorded: list[husky.HuskyRun]) -> str:
    soft = {"PLOUGHED", "UNPLOUGHED"}
    runs = [
        Run(r.name, r.terrain in soft, r.terrain, r.samples)
        for r in recorded
        if len(r.samples) > 300
    ]
    rows = [
        [recipe.name, f"{recipe.samples / husky.RATE_HZ:.2f} s", _accuracy(runs, recipe)]
        for recipe in husky_recipes()
    ]
    return (
        "**Husky**, field soil (ploughed, unploughed) against concrete and dirt road, each run "
        "left out in turn; the only dirt-road run is then unseen ground.\n\n"
        + table(["features", "window", "accuracy (balanced)"], rows)
    )


def wheelchair_recipes() -> list[Recipe]:
    """From the thesis's features to wider ones, at 200 Hz."""
    rate_hz = wheelchair.RATE_HZ
    return [
        Recipe("thesis: vertical, 32 magnitudes to 25 Hz", 256, _thesis_spectrum),
        Recipe("vertical, magnitudes to 100 Hz", 128, lambda w: _magnitudes(w[:, 2:3])),
        Recipe("six axes, magnitudes to 100 Hz", 128, _magnitudes),
        Recipe("six axes, log power in 8 bands", 128, lambda w: band_features(w, rate_hz)),
        Recipe("the same, pooled", 512, lambda w: band_features(w, rate_hz)),
    ]


def husky_recipes() -> list[Recipe]:
    """At 50 Hz."""
    rate_hz = husky.RATE_HZ
    return [
        Recipe("vertical, 32 magnitudes to 12.5 Hz", 128, lambda w: _magnitudes(w[:, 2:3])[:32]),
        Recipe("six axes, log power in 8 bands", 128, lambda w: band_features(w, rate_hz)),
        Recipe("the same, pooled", 256, lambda w: band_features(w, rate_hz)),
    ]


def _thesis_spectrum(window: Array) -> Array:
    """Decimated to 100 Hz: 128 points, 32 magnitudes; the chair has no odometry."""
    vertical = decimate(window[:, 2], 2)
    return np.abs(np.fft.rfft(vertical - vertical.mean()))[:32]


def _magnitudes(window: Array) -> Array:
    return np.abs(np.fft.rfft(window - window.mean(axis=0), axis=0)).T.ravel()


def _accuracy(
    runs: list[Run], recipe: Recipe, still_m_s2: float = STILL_M_S2, *, by_group: bool = False
) -> str:
    """Accuracy and balanced accuracy over all windows, each run or group of runs left out once."""
    features, vegetation, fold = windows_of(runs, recipe, still_m_s2, by_group=by_group)
    found = left_out(features, vegetation, fold)
    right = found == vegetation
    balanced = (right[vegetation].mean() + right[~vegetation].mean()) / 2
    return f"{percent(float(right.mean()), 1)} ({percent(float(balanced), 1)})"


def windows_of(
    runs: list[Run], recipe: Recipe, still_m_s2: float, *, by_group: bool
) -> tuple[Array, NDArray[np.bool_], NDArray[np.int_]]:
    """Features, labels and folds of all windows, half overlapping, in which the vehicle moves."""
    groups = sorted({run.group if by_group else run.name for run in runs})
    features, vegetation, fold = [], [], []
    for each in runs:
        for begin in range(0, len(each.samples) - recipe.samples + 1, recipe.samples // 2):
            window = each.samples[begin : begin + recipe.samples]
            if _shaking(window) < still_m_s2:
                continue
            features.append(recipe.features(window))
            vegetation.append(each.vegetation)
            fold.append(groups.index(each.group if by_group else each.name))
    return np.array(features), np.array(vegetation), np.array(fold)


def left_out(
    features: Array, vegetation: NDArray[np.bool_], fold: NDArray[np.int_]
) -> NDArray[np.bool_]:
    """Classes `(n,)` of windows whose fold was not trained on."""
    found = np.zeros(len(vegetation), np.bool_)
    for left in np.unique(fold):
        training = fold != left
        classifier = train_svm(features[training], vegetation[training], None, PARAMETERS)
        found[~training] = classifier.vegetation_probability(features[~training]) >= 0.5
    return found


def _shaking(window: Array) -> float:
    """Median over eighths of a window, so that no single jolt makes it a drive [m/s^2]."""
    parts = np.array_split(window[:, :3], 8)
    return float(np.median([np.sqrt(part.var(axis=0).sum()) for part in parts]))
