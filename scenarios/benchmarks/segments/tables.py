"""Tables of the report: comparisons with the baseline, sizes of teams, short radio."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from scenarios.batch.comparison import Comparison, mean_interval
from scenarios.exploration.experiments import Row


def comparison_table(comparisons: Sequence[Comparison], rows: Sequence[Row]) -> list[str]:
    """Every team and strategy beside the baseline, paired by their starts."""
    lines = [
        "| team | strategy | pairs | nearest [s] | its time [s] | saved | p (t) | p (Holm) | wins "
        "| driven | decision |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for c in comparisons:
        share = c.gain
        of_strategy = [r for r in rows if r["team"] == c.team and r["strategy"] == c.strategy]
        driven = np.mean([r["driven_m"] for r in of_strategy])
        decision = np.mean([r["decision_cpu_ms"] for r in of_strategy])
        lines.append(
            f"| {c.team} | {c.strategy} | {c.pairs} | {c.reference_value.mean:.0f} "
            f"| {c.value.mean:.0f} | {100 * share.mean:+.1f} % "
            f"({100 * share.low:+.1f} to {100 * share.high:+.1f}) | {c.t_test_p:.2g} "
            f"| {c.holm_p:.2g}{' *' if c.significant else ''} | {c.wins} : {c.losses} "
            f"| {driven:.0f} m | {decision:.1f} ms |"
        )
    return lines


def team_size_table(rows: Sequence[Row], strategies: Sequence[str], baseline: str) -> list[str]:
    """Mean mission time of each team, over the starts that all these strategies have run from."""
    lines = [
        f"| robots | starts | {' | '.join(f'{name} [s]' for name in strategies)} | "
        + " | ".join(f"saved by {name}" for name in strategies if name != baseline)
        + " |",
        "|" + "---|" * (1 + 2 * len(strategies)),
    ]
    for robots in sorted({row["robots"] for row in rows}):
        times = durations([row for row in rows if row["robots"] == robots])
        starts = sorted(
            set.intersection(*({seed for name, seed in times if name == s} for s in strategies))
        )
        if not starts:
            continue
        means = {s: float(np.mean([times[s, seed] for seed in starts])) for s in strategies}
        saved = [
            f"{100 * (1 - means[s] / means[baseline]):+.1f} %" for s in strategies if s != baseline
        ]
        shown = [f"{means[s]:.0f}" for s in strategies]
        lines.append(f"| {robots} | {len(starts)} | {' | '.join(shown + saved)} |")
    return lines


def radio_table(short: Sequence[Row], unlimited: Sequence[Row]) -> list[str]:
    """What a short radio costs: the same starts, with one planner for each cluster of robots."""
    lines = [
        "| team | strategy | pairs | unlimited [s] | short [s] | longer | clusters at most "
        "| driven, unlimited | short |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for robots, strategy in dict.fromkeys((row["robots"], row["strategy"]) for row in short):
        near = {r["seed"]: r for r in short if (r["robots"], r["strategy"]) == (robots, strategy)}
        far = {
            r["seed"]: r for r in unlimited if (r["robots"], r["strategy"]) == (robots, strategy)
        }
        both = sorted(near.keys() & far.keys())
        if not both:
            continue
        longer = mean_interval(
            [100 * (near[seed]["duration_s"] / far[seed]["duration_s"] - 1) for seed in both]
        )
        lines.append(
            f"| {robots} robots | {strategy} | {len(both)} "
            f"| {_mean(far, both, 'duration_s')} | {_mean(near, both, 'duration_s')} "
            f"| {longer.mean:+.0f} % ({longer.low:+.0f} to {longer.high:+.0f}) "
            f"| {max(near[seed]['clusters'] for seed in both)} "
            f"| {_mean(far, both, 'driven_m')} m | {_mean(near, both, 'driven_m')} m |"
        )
    return lines


def durations(rows: Sequence[Row]) -> dict[tuple[str, int], float]:
    """Mission time of every completed run by strategy and start [s]."""
    return {
        (row["strategy"], row["seed"]): row["duration_s"]
        for row in rows
        if row["status"] == "completed"
    }


def _mean(rows: Mapping[int, Row], seeds: Sequence[int], column: str) -> str:
    return f"{np.mean([rows[seed][column] for seed in seeds]):.0f}"
