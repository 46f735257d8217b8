"""Exploration of tables: information gain beside random and frontier viewpoints (Wurm, 5.5.7)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from scenarios.benchmarks.mapping.figures import figure, table
from scenarios.benchmarks.mapping.tables import NEAR_M, as_one
from simulator.mapping.exploration import (
    Choice,
    ExplorationParameters,
    Explorer,
    Step,
    at_random,
    highest_utility,
    nearest_frontier,
    region_entropy,
    region_voxels,
)
from simulator.mapping.oriented_box import OrientedBox
from simulator.mapping.pictures import View, isometric_picture
from simulator.mapping.scene import Box, Cup, DepthSensor, Scene, tabletop_scene
from simulator.mapping.tabletop import TabletopParameters
from simulator.mapping.viewpoints import Viewpoint, look_around

Points = NDArray[np.float32]
SENSOR = DepthSensor(columns=200, rows=150, horizontal_field_rad=0.9, vertical_field_rad=0.7)
REGION_M = ((-0.6, -0.4, 0.76), (0.6, 0.4, 1.05))
TAU = 2.0
OBJECTS = 6


def measure(quick: bool, out: Path) -> str:
    """The curve of entropy against measurements, the same scenes and starts for each choice; and
    what the thesis's choice has found when it ends by itself."""
    seeds = range(2 if quick else 5)
    most = 4 if quick else 5
    choices: dict[str, Choice] = {
        "information gain": highest_utility(-np.inf),
        "frontier": nearest_frontier(),
        "random": at_random,
    }
    entropies = {name: np.full((len(seeds), most + 1), np.nan) for name in choices}
    unknown = {name: np.full((len(seeds), most + 1), np.nan) for name in choices}
    driven = {name: np.zeros((len(seeds), most + 1)) for name in choices}
    finished: list[list[str]] = [
        [
            "scene",
            "measurements until no viewpoint is worth it",
            "objects found",
            "boxes that hold more or less than one",
            "unknown voxels over the table",
            "of them inside objects",
        ]
    ]
    for row, seed in enumerate(seeds):
        scene = tabletop_scene(objects=OBJECTS, seed=seed)
        for name, choose in choices.items():
            for column, step in enumerate(_explorer(scene, most).explore(START, choose, seed)):
                entropies[name][row, column] = region_entropy(step.model.map, REGION_M)
                known = len(step.model.map.known_voxels(REGION_M)[1])
                unknown[name][row, column] = region_voxels(step.model.map, REGION_M) - known
                if step.chosen is not None and column < most:
                    driven[name][row, column + 1] = driven[name][row, column] + step.chosen.cost_s
                elif column < most:  # no frontier is left: it stands still
                    entropies[name][row, column + 1 :] = entropies[name][row, column]
                    unknown[name][row, column + 1 :] = unknown[name][row, column]
                    driven[name][row, column + 1 :] = driven[name][row, column]
        steps = list(_explorer(scene, 20).explore(START, highest_utility(TAU), seed))
        finished.append([str(seed), str(len(steps) - 1), *_found(scene, steps[-1])])
        if row == 0:
            picture = isometric_picture(
                as_one(steps[-1].model.hierarchy, 0.005), View(width_px=700), NEAR_M
            )
            picture.save(out / "explored.png")
    _draw(entropies, unknown, driven, out)
    return (
        f"{_tests(entropies, unknown, driven)}\n\n{len(seeds)} scenes with {OBJECTS} objects; "
        "after a first look around from one corner of the room. Paired t-test against information "
        "gain.\n\n![Entropy against measurements](exploration.svg)\n\n"
        f"With the threshold tau = {TAU}, the exploration ends by itself:\n\n{table(finished)}\n\n"
        "![What was explored in the first scene](explored.png)"
    )


START = look_around((-1.9, -1.5), 1.3, views=8)


def _explorer(scene: Scene, most: int) -> Explorer:
    def look(viewpoint: Viewpoint) -> Points:
        return SENSOR.measure(scene, viewpoint.position_m, viewpoint.yaw_rad, viewpoint.pitch_rad)

    return Explorer(
        SENSOR,
        look,
        segmentation=TabletopParameters(cluster_distance_m=0.02, smallest_table=500),
        parameters=ExplorationParameters(most_measurements=most),
    )


def _found(scene: Scene, step: Step) -> list[str]:
    """How the model compares with the scene."""
    solids = [s for s in scene.solids if _stands_on_table(s)]
    boxes = [
        box
        for node in step.model.hierarchy.nodes()
        if node.label == "object" and (box := node.box()) is not None
    ]
    holds = [sum(_inside(s, box.centre_m[None], 0.01)[0] for box in boxes) for s in solids]
    low, high = np.array(REGION_M[0]) + np.array([0.04, 0.04, 0.03]), np.array(REGION_M[1]) - 0.04
    grid = np.stack(
        np.meshgrid(*[np.arange(a, b, 0.02) for a, b in zip(low, high, strict=True)]), axis=-1
    ).reshape(-1, 3)
    unknown = grid[np.isnan(step.model.map.log_odds(grid))]
    inside = np.any([_inside(s, unknown, 0.03) for s in solids], axis=0)
    return [
        f"{sum(count >= 1 for count in holds)} of {len(solids)}",
        str(sum(count != 1 for count in holds)),
        str(len(unknown)),
        f"{100 * inside.mean():.0f} %" if len(unknown) else "-",
    ]


def _stands_on_table(solid: object) -> bool:
    if isinstance(solid, Cup):
        return solid.base_m[2] == 0.75
    return isinstance(solid, Box) and solid.centre_m[2] > 0.75 and max(solid.size_m) < 1.0


def _inside(solid: object, points_m: NDArray[np.float64], margin_m: float) -> NDArray[np.bool_]:
    """Points within a box, or within a cup up to its rim."""
    if isinstance(solid, Cup):
        local = points_m - np.array(solid.base_m)
        across = np.hypot(local[:, 0], local[:, 1]) <= solid.radius_m + margin_m
        return np.asarray(across & (local[:, 2] <= solid.height_m + margin_m))
    assert isinstance(solid, Box)
    c, s = np.cos(solid.yaw_rad), np.sin(solid.yaw_rad)
    axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    half = np.array(solid.size_m) / 2 + margin_m
    return OrientedBox(np.array(solid.centre_m), axes, half).contains(points_m)


Curves = dict[str, NDArray[np.float64]]


def _tests(entropies: Curves, unknown: Curves, driven: Curves) -> str:
    rows = [["viewpoints", "measurements", "entropy [nat]", "p", "unknown voxels", "driven [s]"]]
    ours = entropies["information gain"]
    for number in (2, 4, ours.shape[1] - 1):
        if number >= ours.shape[1]:
            continue
        for name, runs in entropies.items():
            p = "-"
            if runs is not ours and len(runs) > 2:
                p = f"{stats.ttest_rel(ours[:, number], runs[:, number]).pvalue:.1e}"
            rows.append(
                [
                    name,
                    str(number),
                    f"{runs[:, number].mean():.0f}",
                    p,
                    f"{unknown[name][:, number].mean():.0f}",
                    f"{driven[name][:, number].mean():.1f}",
                ]
            )
    return table(rows)


def _draw(entropies: Curves, unknown: Curves, driven: Curves, out: Path) -> None:
    with figure(out / "exploration.svg", panels=3, width_in=4.2) as axes:
        for colour, name in enumerate(entropies):
            for axis, curves in ((axes[0], entropies), (axes[1], unknown)):
                runs = curves[name]
                mean = runs.mean(axis=0)
                axis.plot(mean, f"C{colour}o-", label=name, markersize=3)
                if len(runs) > 2:
                    half = stats.t.ppf(0.975, len(runs) - 1) * stats.sem(runs, axis=0)
                    at = np.arange(len(mean))
                    axis.fill_between(at, mean - half, mean + half, color=f"C{colour}", alpha=0.2)
            axes[2].plot(
                driven[name].mean(axis=0),
                entropies[name].mean(axis=0),
                f"C{colour}o-",
                markersize=3,
            )
        axes[0].set(xlabel="measurements", ylabel="entropy over the table [nat]")
        axes[1].set(xlabel="measurements", ylabel="unknown voxels over the table")
        axes[2].set(xlabel="driven [s]", ylabel="entropy over the table [nat]")
        axes[0].legend(frameon=False)
