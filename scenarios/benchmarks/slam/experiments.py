"""The experiments of thesis chapter 4: how often each is run, what it writes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from scenarios.benchmarks.slam import figures
from simulator.slam.experiments import (
    corridors,
    parking_lot,
    public_data,
    ten_floors,
    victoria_park,
)
from simulator.slam.experiments.statistics import table
from simulator.slam.robot_map import RobotMap


def run_experiments(
    out: Path, *, quick: bool, data: Path | None, only: Sequence[str] | None = None
) -> str:
    """Runs the chosen experiments; each writes NAME.md and NAME.png into the folder."""
    out.mkdir(parents=True, exist_ok=True)
    parts = []
    for name, experiment in EXPERIMENTS.items():
        if only and name not in only:
            continue
        text = f"## {name}\n\n{experiment(out, quick, data)}"
        (out / f"{name}.md").write_text(text + "\n", encoding="utf-8")
        parts.append(text)
    return "\n\n".join(parts)


def _corridors(out: Path, quick: bool, data: Path | None) -> str:
    del data
    runs = []
    maps: dict[str, RobotMap] = {}
    for seed in range(2 if quick else 10):
        run, maps = corridors.run_once(seed)
        runs.append(run)
    figures.draw_maps(maps, out / "corridors.png")
    return corridors.report(runs)


def _ten_floors(out: Path, quick: bool, data: Path | None) -> str:
    del data
    runs = []
    maps: list[RobotMap] = []
    for seed in range(2 if quick else 9):
        floors = ten_floors.FLOORS[:4] if quick else ten_floors.FLOORS
        run, maps, _ = ten_floors.run_once(seed, floors=floors)
        runs.append(run)
    figures.draw_floors(maps, out / "ten_floors.png")
    return ten_floors.report(runs)


def _victoria_park(out: Path, quick: bool, data: Path | None) -> str:
    random = np.random.default_rng(0)
    file = data / "posegraphs" / "victoria_park_landmarks_est.txt" if data else None
    known = file is not None and file.is_file()
    trunks = victoria_park.read_park(file) if file and known else victoria_park.park(random)
    drivers = [
        victoria_park.snapshots(trunks, random, 30 if quick else 5)
        for _ in range(6 if quick else 20)
    ]
    by_method = {
        "RANSAC": list(victoria_park.trials(drivers, random, "ransac", repeats=1 if quick else 3)),
        "PCM": list(victoria_park.trials(drivers, random, "pcm", step=1 if quick else 6)),
    }
    figures.draw_errors(by_method["RANSAC"], out / "victoria_park.png")
    share = victoria_park.success_below_thirty(by_method["RANSAC"])
    rows = [
        [count, f"{100 * share[count]:.0f} %"] for count in range(3, 30, 2) if share[count] >= 0
    ]
    where = "trunks of the Victoria Park data" if known else "trunks drawn by the seed"
    return (
        f"{len(trunks)} {where}, {len(drivers)} drivers\n\n{victoria_park.report(by_method)}\n\n"
        f"RANSAC below thirty shared landmarks:\n\n{table(['shared', 'right and accepted'], rows)}"
    )


def _parking_lot(out: Path, quick: bool, data: Path | None) -> str:
    del data
    rows = []
    for seed in range(2 if quick else 10):
        run = parking_lot.run_once(seed)
        rows.append(
            [
                seed,
                f"{run.accepted} of 3",
                run.wrong,
                f"{max(run.odometry_error_m.values()):.2f}",
                f"{max(run.error_m.values()):.3f}",
                f"{run.pole_error_m:.3f}",
                ", ".join(run.merged.alone) or "none",
            ]
        )
        if seed == 0:
            figures.draw_lot(run, out / "parking_lot.png")
    heads = [
        "run",
        "pairs aligned",
        "wrong",
        "odometry, worst robot [m]",
        "joint, worst robot [m]",
        "poles [m]",
        "left alone",
    ]
    return table(heads, rows)


def _public_data(out: Path, quick: bool, data: Path | None) -> str:
    if data is None or not data.is_dir():
        return f"Left out: {data} is not here."
    parts = [
        public_data.pose_graphs(data / "posegraphs"),
        public_data.mrclam(data / "mrclam" / "D6"),
        public_data.victoria_park(data / "posegraphs" / "victoria_park.txt"),
    ]
    logs = {"intel": ("intel", [(0.0, 0.4), (0.3, 0.7), (0.6, 1.0)])}
    if not quick:
        logs["fr079"] = ("freiburg-079", [(0.0, 0.6), (0.4, 1.0)])
    for raw, (corrected, shares) in logs.items():
        text, merged = public_data.split_log(
            data / "carmen_raw" / f"{raw}.clf.bz2",
            data / "carmen" / f"{corrected}-corrected.log.gz",
            shares,
        )
        parts.append(text)
        figures.draw_merged(merged, out / f"{raw}.png")
    return "\n\n".join(parts)


EXPERIMENTS: dict[str, Callable[[Path, bool, Path | None], str]] = {
    "corridors": _corridors,
    "ten_floors": _ten_floors,
    "victoria_park": _victoria_park,
    "parking_lot": _parking_lot,
    "public_data": _public_data,
}
"""name -> experiment(out, quick, data): Markdown"""
