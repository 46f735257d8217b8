"""Section 6.9.4: a goal 80 m away, no map, no grass to be touched."""

from __future__ import annotations

import numpy as np

from simulator.vegetation.experiments import Setting
from simulator.vegetation.experiments.report import draw_grid, draw_material, figure, save, table
from simulator.vegetation.experiments.training import trained_by_itself
from simulator.vegetation.navigation import NavigationParameters, NavigationRecord, navigate
from simulator.vegetation.simulation.recording import PIONEER
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.worlds import Campus, CampusParameters, campus

SEEDS = (21, 22, 24)
DISTANCE_M = 80.0


def run(setting: Setting) -> str:
    """Writes `navigation.png` and returns the table."""
    seeds: tuple[int, ...] = SEEDS
    distance_m, size_m = DISTANCE_M, (110.0, 80.0)
    if setting.quick:
        seeds, distance_m, size_m = SEEDS[:1], 25.0, (45.0, 35.0)
    model = trained_by_itself(quick=setting.quick)
    rows, shown = [], None
    for seed in seeds:
        place = campus(seed, CampusParameters(size_m))
        for avoid in (True, False):
            parameters = NavigationParameters(avoid_vegetation=avoid)
            start, goal = _ends(place, distance_m)
            towards = float(np.arctan2(*(goal - start)[::-1]))
            record = navigate(
                place.world,
                (float(start[0]), float(start[1]), towards),
                (float(goal[0]), float(goal[1])),
                model,
                PIONEER,
                np.random.default_rng(seed),
                parameters,
            )
            driven = np.array(record.positions_m)
            touched = place.world.touched(driven, parameters.radius_m)
            rows.append(
                [
                    str(seed),
                    f"{np.linalg.norm(goal - start):.0f} m",
                    "avoided" if avoid else "ignored",
                    "yes" if record.reached else f"no: {record.reason}",
                    f"{record.length_m():.0f} m",
                    str(record.scans),
                    str(int((touched == Material.LAWN).sum())),
                    str(int((touched == Material.GRAVEL).sum())),
                ]
            )
            shown = shown or (place, record, goal)
    if shown is not None:
        _draw(setting, *shown)
    heads = [
        "place",
        "distance",
        "vegetation",
        "goal reached",
        "driven",
        "3D scans",
        "lawn cells touched",
        "overgrown gravel cells touched",
    ]
    return "\n".join(
        [
            "### Section 6.9.4: to a goal without a map\n",
            "Cells of 0.1 m under the robot's disc of 0.45 m, in the simulated truth. The "
            "classifier was trained by the robot itself in another place.\n",
            table(heads, rows),
            "![driven way](navigation.png)\n",
        ]
    )


def _ends(place: Campus, distance_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Two places where paths meet, about as far apart as asked for."""
    nodes = place.nodes_m
    apart = np.linalg.norm(nodes[:, None] - nodes[None], axis=2)
    first, second = np.unravel_index(np.argmin(np.abs(apart - distance_m)), apart.shape)
    return nodes[first], nodes[second]


def _draw(setting: Setting, place: Campus, record: NavigationRecord, goal: np.ndarray) -> None:
    made, axes = figure(9, 7)
    draw_material(axes, place.world.material, place.world.resolution_m)
    if record.grid is not None:
        draw_grid(axes, record.grid)
    driven = np.array(record.positions_m)
    axes.plot(driven[:, 0], driven[:, 1], "r", lw=1.5)
    axes.plot(*goal, "r*", ms=14)
    axes.set_title("truth (pale), map (green: vegetation, blue: other ground), driven way (red)")
    save(made, setting.out / "navigation.png")
