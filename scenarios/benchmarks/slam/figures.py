"""Figures of the SLAM experiments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from simulator.slam.experiments.parking_lot import LotRun
from simulator.slam.experiments.victoria_park import Trial
from simulator.slam.merging import MergedMap
from simulator.slam.robot_map import RobotMap, map_with_known_poses


def _axes(rows: int, size: tuple[float, float]) -> tuple[Any, list[Any]]:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(rows, 1, figsize=size, squeeze=False)
    return figure, list(axes[:, 0])


def _save(figure: Any, path: Path) -> None:
    import matplotlib.pyplot as plt

    figure.tight_layout()
    figure.savefig(path, dpi=90)
    plt.close(figure)


def draw_maps(maps: Mapping[str, RobotMap], path: Path) -> None:
    """One map under the other, each turned so that its longest extent lies along x."""
    figure, axes = _axes(len(maps), (12.0, 2.0 * len(maps)))
    for axis, (name, robot_map) in zip(axes, maps.items(), strict=True):
        at = robot_map.graph.trajectory()[:, :2]
        _, _, directions = np.linalg.svd(at - at.mean(axis=0), full_matrices=False)
        turn = -np.arctan2(directions[0, 1], directions[0, 0])
        turned = robot_map.with_graph(robot_map.graph.moved(np.array([0.0, 0.0, turn])))
        low = turned.graph.trajectory()[:, 0].min()
        turned = turned.with_graph(turned.graph.moved(np.array([-low, 0.0, 0.0])))
        _show(axis, [turned])
        axis.set_title(name)
        axis.set_xlim(-6.0, 136.0)
    _save(figure, path)


def _show(axis: Any, robot_maps: Sequence[RobotMap]) -> None:
    grid = map_with_known_poses(robot_maps, 0.1, 15.0)
    rows, columns = grid.cells.shape
    x, y = grid.origin_m
    extent = (x, x + columns * grid.resolution_m, y, y + rows * grid.resolution_m)
    shade = np.where(grid.cells < 0, 30, grid.cells)
    axis.imshow(shade, origin="lower", cmap="gray_r", extent=extent, vmin=0, vmax=100)
    axis.set_aspect("equal")
    axis.set_xlabel("x [m]")


def draw_floors(maps: Sequence[RobotMap], path: Path) -> None:
    """Walls of all floors over one another, after the alignment."""
    figure, (axis,) = _axes(1, (12.0, 5.0))
    for number, robot_map in enumerate(maps):
        grid = map_with_known_poses([robot_map], 0.1, 15.0)
        rows, columns = np.nonzero(grid.cells >= 60)
        x, y = grid.origin_m
        axis.plot(x + 0.1 * columns, y + 0.1 * rows, ",", label=f"floor {number + 1}")
    axis.set_aspect("equal")
    axis.set_xlabel("x [m]")
    axis.set_ylabel("y [m]")
    _save(figure, path)


def draw_merged(merged: MergedMap, path: Path) -> None:
    """The joint map and each robot's way."""
    figure, (axis,) = _axes(1, (11.0, 9.0))
    _show(axis, list(merged.robot_maps.values()))
    for name, robot_map in merged.robot_maps.items():
        at = robot_map.graph.trajectory()
        axis.plot(at[:, 0], at[:, 1], linewidth=0.8, label=name)
    axis.legend()
    _save(figure, path)


def draw_errors(trials: Sequence[Trial], path: Path) -> None:
    """Error of accepted alignments by shared landmarks (Fig. 4.16 and 4.17)."""
    figure, axes = _axes(2, (9.0, 7.0))
    accepted = [trial for trial in trials if trial.accepted]
    shared = np.array([trial.shared for trial in accepted])
    for axis, values, unit in (
        (axes[0], np.array([trial.error_m for trial in accepted]), "translation [m]"),
        (axes[1], np.array([trial.error_rad for trial in accepted]), "rotation [rad]"),
    ):
        centres, means, spreads = [], [], []
        for low in range(0, 151, 10):
            group = values[(shared >= low) & (shared < low + 10)]
            if len(group):
                centres.append(low + 5)
                means.append(group.mean())
                spreads.append(group.std())
        axis.bar(centres, means, width=8.0, yerr=spreads, color="0.75", ecolor="0.3", capsize=3)
        axis.set_xlabel("shared landmarks")
        axis.set_ylabel(f"error of the {unit}")
    _save(figure, path)


def draw_lot(run: LotRun, path: Path) -> None:
    """The robots' joint trajectories and landmarks over the true poles."""
    from simulator.slam.pose import fit_motion, transform

    figure, (axis,) = _axes(1, (10.0, 7.5))
    names = list(run.merged.robot_maps)
    estimate = np.concatenate([run.merged.robot_maps[n].graph.trajectory()[:, :2] for n in names])
    truth = np.concatenate([run.tracks[name][:, :2] for name in names])
    motion = fit_motion(estimate, truth)
    for name in names:
        graph = run.merged.robot_maps[name].graph
        at = transform(motion, graph.trajectory()[:, :2])
        line = axis.plot(at[:, 0], at[:, 1], linewidth=1.0, label=name)[0]
        marks = transform(motion, graph.landmark_positions())
        axis.plot(marks[:, 0], marks[:, 1], "+", color=line.get_color(), markersize=9)
    axis.plot(run.poles_m[:, 0], run.poles_m[:, 1], "ko", fillstyle="none", label="poles")
    axis.set_aspect("equal")
    axis.set_xlabel("x [m]")
    axis.set_ylabel("y [m]")
    axis.legend()
    _save(figure, path)
