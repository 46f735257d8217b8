"""Writes what a suite found: `runs.csv`, `comparisons.csv`, `report.html`, `report.md`, figures."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from math import isnan
from pathlib import Path

from scenarios.batch import figure
from scenarios.batch.comparison import Comparison, Interval, Measure, Row
from scenarios.batch.execution import TABLE
from scenarios.batch.figure import Series, bars
from scenarios.batch.findings import CONDITIONS, COUNTS, ONE_STEP, Findings
from scenarios.batch.suite import MapEntry

COLUMNS = (
    "team",
    "against",
    "its mean",
    "the other's",
    "better by",
    "p (t, Holm)",
    "p (Wilcoxon)",
    "effect d",
    "won / lost",
    "pairs",
    "not completed",
)


def write(found: Findings, folder: Path) -> Path:
    """Writes all files and returns the path of the HTML report."""
    _write_runs(found.rows, folder / TABLE)
    _write_parquet(found.rows, folder / "runs.parquet")
    _write_comparisons(found.comparisons, folder / "comparisons.csv")
    for entry in found.suite.maps:
        for measure in found.measures(entry):
            drawn = figure.file(*_chart(found, entry, measure))
            (folder / _figure_name(entry, measure)).write_text(drawn, encoding="utf-8")
    (folder / "report.md").write_text(markdown(found), encoding="utf-8")
    path = folder / "report.html"
    path.write_text(page(found), encoding="utf-8")
    return path


def markdown(found: Findings) -> str:
    """Tables in Markdown."""
    lines = [f"# {found.suite.title or found.suite.name}", "", found.provenance(), ""]
    lines += [_explanation(found), ""]
    for entry in found.suite.maps:
        for measure in found.measures(entry):
            compared = found.of(entry, measure)
            if compared:
                title = _heading(entry, measure)
                lines += [f"## {title}", "", f"![{title}]({_figure_name(entry, measure)})", ""]
                lines += [*_table(COLUMNS, compared), ""]
    for title, names, rows in _summaries(found):
        lines += [f"## {title}", "", f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
        lines += [*(f"| {' | '.join(row)} |" for row in rows), ""]
    return "\n".join(lines)


def page(found: Findings) -> str:
    """The self-contained HTML report."""
    room = files("scenarios.report")
    style = room.joinpath("style.css").read_text(encoding="utf-8")
    sections = "".join(
        _section(found, entry, measure)
        for entry in found.suite.maps
        for measure in found.measures(entry)
    )
    sections += "".join(
        f"<section><h2>{escape(title)}</h2>{_html_table(names, rows)}</section>"
        for title, names, rows in _summaries(found)
    )
    name = escape(found.suite.title or found.suite.name)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{name}</title>
<style>
{style}</style></head>
<body><main>
<header><h1>{name}</h1><p>{escape(found.provenance())}</p>
<p class="note">{escape(_explanation(found))}</p></header>
{sections}
</main></body></html>
"""


def percent(share: Interval) -> str:
    """`12.3 % (10.1 to 14.5)`, no interval if it has no width, or that no pair completed."""
    if isnan(share.mean):
        return "no completed pair"
    if share.low == share.high:
        return f"{100 * share.mean:.1f} %"
    return f"{100 * share.mean:.1f} % ({100 * share.low:.1f} to {100 * share.high:.1f})"


def _explanation(found: Findings) -> str:
    return (
        f"{found.suite.compared} against each other strategy, paired over equal map, team and "
        "seed, completed runs only. p: paired t-test with Holm's correction over the teams of a "
        "map (* below 5 %), and Wilcoxon's signed-rank test; d: Cohen's d of the differences. "
        "Intervals: 95 %."
    )


def _heading(entry: MapEntry, measure: Measure) -> str:
    name = f"{entry.name}: {entry.figure}" if entry.figure else entry.name
    return f"{name}, {measure.name} [{measure.unit}]"


def _summaries(found: Findings) -> Iterable[tuple[str, tuple[str, ...], list[list[str]]]]:
    yield (
        f"Time that {found.suite.compared} saves over all teams",
        ("map", "against", "placements as a random effect"),
        [[entry.name, other, percent(saved)] for entry, other, saved in found.overall()],
    )
    yield (
        "How the missions went (means)",
        ("map", "strategy", *CONDITIONS),
        [
            [entry.name, strategy, *map(_number, values)]
            for entry, strategy, values in found.conditions()
        ],
    )
    yield (
        "What has to be zero, and orders without a plan",
        ("strategy", "runs", *COUNTS, ONE_STEP),
        [
            [strategy, str(runs), *("" if count is None else str(count) for count in counts)]
            for strategy, runs, counts in found.counts()
        ],
    )


def _number(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def _cells(c: Comparison) -> list[str]:
    digits = 0 if c.measure.less_is_better else 2
    tests = ["-", "-", "-"]
    # One pair says nothing of chance.
    if c.pairs > 1:
        tests = [
            f"{c.holm_p:.2g}{' *' if c.significant else ''}",
            f"{c.wilcoxon_p:.2g}",
            f"{c.effect.mean:.2f} ({c.effect.low:.2f} to {c.effect.high:.2f})",
        ]
    return [
        c.team,
        c.reference,
        f"{c.value.mean:.{digits}f}",
        f"{c.reference_value.mean:.{digits}f}",
        percent(c.gain),
        *tests,
        f"{c.wins} / {c.losses}",
        str(c.pairs),
        f"{c.failures} / {c.reference_failures}",
    ]


def _table(names: Sequence[str], compared: Sequence[Comparison]) -> list[str]:
    lines = [f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
    return lines + [f"| {' | '.join(_cells(c))} |" for c in compared]


def _html_table(names: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(text)}</td>' for text in row)}</tr>" for row in rows
    )
    return f'<div class="scroll"><table><tr>{head}</tr>{body}</table></div>'


def _figure_name(entry: MapEntry, measure: Measure) -> str:
    return re.sub(r"[^a-z0-9]+", "_", f"{entry.name} {measure.name}".lower()) + ".svg"


def _chart(
    found: Findings, entry: MapEntry, measure: Measure
) -> tuple[list[str], list[Series], str]:
    strategies = found.strategies(entry)
    values = found.values(entry, measure, strategies)
    series = [
        Series(strategy, tuple(of_team[k] for of_team in values.values()))
        for k, strategy in enumerate(strategies)
    ]
    return list(values), series, f"{measure.name} [{measure.unit}]"


def _section(found: Findings, entry: MapEntry, measure: Measure) -> str:
    names, series, unit = _chart(found, entry, measure)
    legend = "".join(
        f'<li><i class="key line robot-{k % 8}"></i>{escape(one.name)}</li>'
        for k, one in enumerate(series)
    )
    chart = bars(names, series, unit)
    compared = found.of(entry, measure)
    table = _html_table(COLUMNS, (_cells(c) for c in compared)) if compared else ""
    return (
        f"<section><h2>{escape(_heading(entry, measure))}</h2>{chart}"
        f'<ul class="legend">{legend}</ul>{table}</section>'
    )


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
            "measure": c.measure.name,
            "map": c.map,
            "team": c.team,
            "strategy": c.strategy,
            "reference": c.reference,
            "pairs": c.pairs,
            "mean": c.value.mean,
            "reference_mean": c.reference_value.mean,
            "gain": c.gain.mean,
            "gain_low": c.gain.low,
            "gain_high": c.gain.high,
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
