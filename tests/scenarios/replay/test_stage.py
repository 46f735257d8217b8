"""What a replay shows on a terminal, and without one."""

from pathlib import Path
from typing import Any

from typer.testing import CliRunner

from scenarios.application import application
from scenarios.replay.log import events_of
from scenarios.replay.record import moments
from scenarios.replay.stage import lines, picture

Told = tuple[str, dict[str, Any]]


def test_each_decision_is_a_line_and_the_end_is_the_last(told: Told) -> None:
    url, mission = told
    shown = lines(events_of("latest", db=url))
    assert len(shown) == len(mission["decisions"]) + 1
    assert "3 of 3 targets visited" in shown[-1]


def test_the_picture_shows_walls_robots_and_targets(told: Told) -> None:
    frames = []
    for moment in moments(events_of("latest", db=told[0])):
        text = picture(moment.mission, 40, 12).plain
        if not frames or frames[-1] != text:
            frames.append(text)
    assert len(frames) > 10
    first, last = frames[0], frames[-1]
    assert first.count("○") + first.count("e") + first.count("c") >= 4
    assert "✓" not in first
    assert "✓" in last
    assert any("#" in frame for frame in frames)
    for frame in frames:
        rows = frame.rstrip("\n").split("\n")
        assert max(map(len, rows)) <= 40
        # Walls all round, as the map has them; a row of characters stands for two of cells.
        assert set(rows[0]) == {"█"}
        assert {row[0] for row in rows} == {row[-1] for row in rows} == {"█"}


def test_the_command_plays_and_writes_a_report(told: Told, tmp_path: Path) -> None:
    page = tmp_path / "deep" / "replay.html"
    words = ["replay", "latest", "--db", told[0], "--report", str(page)]
    result = CliRunner().invoke(application(words), words)
    assert result.exit_code == 0, result.output
    assert "completed: every target is visited" in result.output
    assert page.read_text().startswith("<!doctype html>")
