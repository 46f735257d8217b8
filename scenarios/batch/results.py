"""Writes what a suite found: `runs.csv`, `comparisons.csv`, `report.html`, `report.md`."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from math import isnan
from pathlib import Path

from scenarios.batch.comparison import (
    Comparison,
    Interval,
    Row,
    cells,
    compare,
    mean_interval,
    over_placements,
)
from scenarios.batch.figure import Series, bars
from scenarios.batch.suite import MapEntry, Suite

COUNTS: dict[str, Callable[[Row], int]] = {
    "not completed": lambda row: row["status"] != "completed",
    "stuck": lambda row: row["status"] == "stuck",
    "out of time": lambda row: row["status"] == "out of time",
    "crashed or killed": lambda row: row["status"] in ("crashed", "killed"),
    "wall collisions": lambda row: row.get("wall_collisions", 0),
    "robot contacts": lambda row: row.get("robot_collisions", 0),
    "blockade crossings": lambda row: row.get("blockade_crossings", 0),
}
"""what has to be zero, and how a row tells"""


@dataclass(frozen=True)
class Findings:
    """Everything that the report shows."""

    suite: Suite
    rows: list[Row]
    comparisons: list[Comparison]


def findings(suite: Suite, rows: Sequence[Row]) -> Findings:
    """Compares every strategy with the reference."""
    reference = suite.compared_with
    comparisons = [
        comparison
        for strategy in suite.strategies
        if strategy != reference
        for comparison in compare(rows, strategy, reference)
    ]
    return Findings(suite, list(rows), comparisons)


def write(found: Findings, folder: Path) -> Path:
    """Writes all files and returns the path of the HTML report."""
    _write_runs(found.rows, folder / "runs.csv")
    _write_parquet(found.rows, folder / "runs.parquet")
    _write_comparisons(found.comparisons, folder / "comparisons.csv")
    (folder / "report.md").write_text(markdown(found), encoding="utf-8")
    path = folder / "report.html"
    path.write_text(page(found), encoding="utf-8")
    return path


def markdown(found: Findings) -> str:
    """Tables in Markdown."""
    lines = [f"# {found.suite.title or found.suite.name}", "", _provenance(found), ""]
    lines += [
        "| map | team | strategy | mission time [s] | reference [s] | faster | p (t, Holm) "
        "| p (Wilcoxon) | effect d | won / lost | pairs |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for c in found.comparisons:
        mark = " **" if c.significant else ""
        lines.append(
            f"| {c.map} | {c.team} | {c.strategy} | {c.time_s.mean:.0f} "
            f"| {c.reference}: {c.reference_time_s.mean:.0f} "
            f"| {mark}{percent(c.faster)}{mark.strip()} | {c.holm_p:.2g} | {c.wilcoxon_p:.2g} "
            f"| {c.effect.mean:.2f} ({c.effect.low:.2f} to {c.effect.high:.2f}) "
            f"| {c.wins} / {c.losses} | {c.pairs} |"
        )
    lines += ["", "| map | strategy | faster over all teams and placements |", "|---|---|---|"]
    for entry, strategy, saved in _overall(found):
        lines.append(f"| {entry.name} | {strategy} | {percent(saved)} |")
    names = list(COUNTS)
    lines += ["", f"| strategy | runs | {' | '.join(names)} |", "|---" * (len(names) + 2) + "|"]
    for strategy, runs, counts in _counts(found):
        lines.append(f"| {strategy} | {runs} | {' | '.join(map(str, counts))} |")
    return "\n".join(lines) + "\n"


def page(found: Findings) -> str:
    """The self-contained HTML report."""
    room = files("scenarios.report")
    style = room.joinpath("style.css").read_text(encoding="utf-8")
    figures = "".join(_figure(found, entry) for entry in found.suite.maps)
    name = escape(found.suite.title or found.suite.name)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{name}</title>
<style>
{style}</style></head>
<body><main>
<header><h1>{name}</h1><p>{escape(_provenance(found))}</p></header>
{figures}
<section><h2>Comparisons</h2>{_comparison_table(found)}
<p class="note">Paired over equal map, team and seed, completed runs only. p: paired t-test with
Holm's correction over the teams of a map; d: Cohen's d of the differences. Intervals: 95 %.</p>
</section>
<section><h2>What has to be zero</h2>{_count_table(found)}</section>
</main></body></html>
"""


def percent(share: Interval) -> str:
    """`12.3 % (10.1 to 14.5)`, or that no pair of runs completed."""
    if isnan(share.mean):
        return "no completed pair"
    return f"{100 * share.mean:.1f} % ({100 * share.low:.1f} to {100 * share.high:.1f})"


def _figure(found: Findings, entry: MapEntry) -> str:
    grouped = {team: cell for (name, team), cell in cells(found.rows).items() if name == entry.name}
    order = [t for t in _teams(found.suite) if t in grouped]
    series = [
        Series(strategy, tuple(_time(grouped[team], strategy) for team in order))
        for strategy in found.suite.strategies
    ]
    legend = "".join(
        f'<li><i class="key line robot-{k % 8}"></i>{escape(one.name)}</li>'
        for k, one in enumerate(series)
    )
    overall = "".join(
        f"<p>{escape(strategy)} against {escape(found.suite.compared_with)} over all teams, time "
        f"saved, placements as a random effect: {percent(saved)}.</p>"
        for map_entry, strategy, saved in _overall(found)
        if map_entry.name == entry.name
    )
    heading = escape(f"{entry.name}: {entry.figure}" if entry.figure else entry.name)
    chart = bars(order, series, "mission time [s]")
    return f'<section><h2>{heading}</h2>{chart}<ul class="legend">{legend}</ul>{overall}</section>'


def _teams(suite: Suite) -> list[str]:
    return list(dict.fromkeys(spec.team_name for spec in suite.runs()))


def _time(cell: Sequence[Row], strategy: str) -> Interval | None:
    times = [
        row["duration_s"]
        for row in cell
        if row["strategy"] == strategy and row["status"] == "completed"
    ]
    return mean_interval(times) if times else None


def _overall(found: Findings) -> list[tuple[MapEntry, str, Interval]]:
    reference = found.suite.compared_with
    return [
        (entry, strategy, over_placements(found.rows, entry.name, strategy, reference))
        for entry in found.suite.maps
        for strategy in found.suite.strategies
        if strategy != reference and any(row["map"] == entry.name for row in found.rows)
    ]


def _counts(found: Findings) -> list[tuple[str, int, list[int]]]:
    result = []
    for strategy in found.suite.strategies:
        own = [row for row in found.rows if row["strategy"] == strategy]
        counts = [sum(int(tell(row)) for row in own) for tell in COUNTS.values()]
        result.append((strategy, len(own), counts))
    return result


def _provenance(found: Findings) -> str:
    done, wanted = len(found.rows), len(found.suite.runs())
    if not found.rows:
        return f"0 of {wanted} runs."
    revisions = ", ".join(sorted({str(row["revision"]) for row in found.rows}))
    first = found.rows[0]
    computed_h = sum(row.get("cpu_s", 0.0) for row in found.rows) / 3600
    return (
        f"{done} of {wanted} runs, {computed_h:.1f} CPU hours; revision {revisions}, marsupial "
        f"{first['version']}, Python {first['python']}, numpy {first['numpy']}, "
        f"pymunk {first['pymunk']}."
    )


def _comparison_table(found: Findings) -> str:
    body = "".join(
        "<tr>"
        + "".join(
            f"<td>{escape(text)}</td>"
            for text in (
                c.map,
                c.team,
                c.strategy,
                f"{c.time_s.mean:.0f} s",
                f"{c.reference_time_s.mean:.0f} s",
                percent(c.faster),
                f"{c.holm_p:.2g}{' *' if c.significant else ''}",
                f"{c.wilcoxon_p:.2g}",
                f"{c.effect.mean:.2f} ({c.effect.low:.2f} to {c.effect.high:.2f})",
                f"{c.wins} / {c.losses}",
                f"{c.failures} / {c.reference_failures}",
            )
        )
        + "</tr>"
        for c in found.comparisons
    )
    names = (
        "map",
        "team",
        "strategy",
        "time",
        "reference",
        "faster",
        "p Holm",
        "p Wilcoxon",
        "d",
        "won / lost",
        "failed",
    )
    head = "".join(f"<th>{name}</th>" for name in names)
    return f'<div class="scroll"><table><tr>{head}</tr>{body}</table></div>'


def _count_table(found: Findings) -> str:
    head = "".join(f"<th>{escape(name)}</th>" for name in ("strategy", "runs", *COUNTS))
    body = "".join(
        f"<tr><td>{escape(strategy)}</td><td>{runs}</td>"
        + "".join(f"<td>{count}</td>" for count in counts)
        + "</tr>"
        for strategy, runs, counts in _counts(found)
    )
    return f'<div class="scroll"><table><tr>{head}</tr>{body}</table></div>'


def _write_runs(rows: Sequence[Row], path: Path) -> None:
    names = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(rows)


def _write_parquet(rows: Sequence[Row], path: Path) -> None:
    """The same table for those who have `marsupial[results]`; the CSV file needs nothing."""
    try:
        from pyarrow import Table, parquet
    except ImportError:
        return
    names = list(dict.fromkeys(name for row in rows for name in row))
    parquet.write_table(Table.from_pylist([{n: row.get(n) for n in names} for row in rows]), path)


def _write_comparisons(comparisons: Sequence[Comparison], path: Path) -> None:
    rows: list[Row] = [
        {
            "map": c.map,
            "team": c.team,
            "strategy": c.strategy,
            "reference": c.reference,
            "pairs": c.pairs,
            "time_s": c.time_s.mean,
            "reference_time_s": c.reference_time_s.mean,
            "faster": c.faster.mean,
            "faster_low": c.faster.low,
            "faster_high": c.faster.high,
            "t_test_p": c.t_test_p,
            "wilcoxon_p": c.wilcoxon_p,
            "holm_p": c.holm_p,
            "effect": c.effect.mean,
            "effect_low": c.effect.low,
            "effect_high": c.effect.high,
            "wins": c.wins,
            "losses": c.losses,
            "failures": c.failures,
            "reference_failures": c.reference_failures,
        }
        for c in comparisons
    ]
    _write_runs(rows, path)
