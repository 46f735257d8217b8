"""Experiments are paired by their starts and go on where they were stopped."""

from pathlib import Path

import pytest

from scenarios.exit_codes import CommandError
from scenarios.exploration.experiments import Experiment, drawn, read_rows, run_all


def test_every_combination_is_run_once_and_a_stopped_experiment_goes_on(tmp_path: Path) -> None:
    experiment = Experiment("tiny", drawn("small_rooms", (1, 2)), (6,), 2, ("nearest", "greedy"))
    file = tmp_path / "runs.csv"
    counts: list[tuple[int, int]] = []

    def progress(done: int, total: int) -> None:
        counts.append((done, total))

    rows = run_all([experiment], file, progress)
    assert [(row["seed"], row["map_seed"], row["strategy"]) for row in rows] == [
        (0, 1, "nearest"),
        (0, 1, "greedy"),
        (1, 2, "nearest"),
        (1, 2, "greedy"),
    ]
    assert counts == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert all(row["map"] == "tiny" and row["status"] == "completed" for row in rows)
    assert read_rows(file) == rows

    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    file.write_text("".join(lines[:4]), encoding="utf-8")
    again = run_all([experiment], file, progress)
    assert counts[4:] == [(4, 4)]
    same = ("seed", "strategy", "duration_s", "driven_m", "known_share")
    assert [[row[k] for k in same] for row in again] == [[row[k] for k in same] for row in rows]


def test_a_line_cut_off_by_a_kill_is_named(tmp_path: Path) -> None:
    file = tmp_path / "runs.csv"
    file.write_text("map,robots,seed,strategy\nm,2,0,nearest\nm,2", encoding="utf-8")
    with pytest.raises(CommandError, match=r"runs\.csv:3: this line is no run; remove it"):
        read_rows(file)
