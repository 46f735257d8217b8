"""Tables are about the runs that are there, and only about complete pairs."""

from scenarios.benchmarks.segments.tables import durations, radio_table, team_size_table
from scenarios.exploration.experiments import Row


def row(robots: int, seed: int, strategy: str, duration_s: float, clusters: int = 1) -> Row:
    return {
        "robots": robots,
        "seed": seed,
        "strategy": strategy,
        "status": "completed" if duration_s < 1000.0 else "incomplete",
        "duration_s": duration_s,
        "driven_m": 0.5 * duration_s,
        "clusters": clusters,
    }


def test_team_sizes_are_compared_over_the_starts_that_all_have_run_from() -> None:
    rows = [
        row(12, 0, "nearest", 100.0),
        row(12, 0, "segments", 80.0),
        row(12, 1, "nearest", 200.0),
        row(2, 0, "nearest", 400.0),
        row(2, 0, "segments", 440.0),
        row(4, 0, "nearest", 300.0),
        row(4, 0, "segments", 2000.0),
    ]
    lines = team_size_table(rows, ("nearest", "segments"), "nearest")
    assert lines[2:] == ["| 2 | 1 | 400 | 440 | -10.0 % |", "| 12 | 1 | 100 | 80 | +20.0 % |"]
    assert lines[0].count("|") == lines[1].count("|") == lines[2].count("|")


def test_a_short_radio_is_compared_with_the_same_starts() -> None:
    unlimited = [row(4, seed, "nearest", 100.0 + seed) for seed in range(3)]
    short = [row(4, 1, "nearest", 151.5, clusters=3), row(4, 2, "nearest", 153.0, clusters=2)]
    (line,) = radio_table(short, unlimited)[2:]
    assert line.startswith("| 4 robots | nearest | 2 | 102 | 152 | +50 % (+50 to +50) | 3 |")


def test_runs_that_did_not_complete_have_no_duration() -> None:
    assert durations([row(4, 0, "planner", 5000.0)]) == {}
