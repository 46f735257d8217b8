"""Bar charts with confidence intervals as SVG: one picture for each figure of the thesis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape

from scenarios.batch.comparison import Interval
from scenarios.report.markup import element, title

_INKS = ("#1d6fd6", "#0b8f7a", "#c2570c", "#a3269b", "#6a7a00", "#5b4bd1", "#b01e4f", "#7a5a2e")
_STYLE = (
    "text { font: 12px system-ui, sans-serif; fill: #16202b } .tick { text-anchor: end } "
    ".group { text-anchor: middle } .grid { stroke: #dfe4ea } "
    ".error { stroke: #16202b; stroke-width: 1.3px; fill: none } "
)
_STEPS = (1, 1.2, 1.6, 2, 2.4, 3.2, 4, 5, 6, 8, 10)
WIDTH, HEIGHT, LEFT, TOP, BOTTOM = 1000, 352, 62, 28, 58


@dataclass(frozen=True)
class Series:
    """One strategy's bars: a value for each group, None where there is none."""

    name: str
    values: tuple[Interval | None, ...]


def bars(groups: Sequence[str], series: Sequence[Series], unit: str) -> str:
    """Grouped bars with error bars (95 % intervals)."""
    ends = [value.high for one in series for value in one.values if value is not None]
    top = _round_up(max(ends, default=1.0))
    plot = HEIGHT - TOP - BOTTOM

    def y(value: float) -> float:
        return TOP + plot * (1 - value / top)

    wide = (WIDTH - LEFT - 8) / max(1, len(groups))
    bar = min(26.0, 0.8 * wide / max(1, len(series)))
    drawn = [_grid(top, y), element("text", escape(unit), class_="unit", x=0, y=12)]
    for k, group in enumerate(groups):
        middle = LEFT + wide * (k + 0.5)
        for s, one in enumerate(series):
            value = one.values[k]
            if value is not None:
                x = middle + (s - (len(series) - 1) / 2) * bar
                drawn.append(_bar(one.name, group, value, s, x=x, width=bar - 2, y=y))
        drawn += [
            element("text", escape(line), class_="group", x=middle, y=HEIGHT - BOTTOM + 18 + 15 * n)
            for n, line in enumerate(group.split(" + "))
        ]
    return element("svg", "".join(drawn), class_="figure", viewBox=f"0 0 {WIDTH} {HEIGHT}")


def file(groups: Sequence[str], series: Sequence[Series], unit: str) -> str:
    """The same chart as a file of its own: with colours, a ground and a legend."""
    inks = "".join(f".robot-{k} {{ fill: {ink} }} " for k, ink in enumerate(_INKS))
    keys = []
    x = float(LEFT)
    for k, one in enumerate(series):
        keys.append(
            element("rect", class_=f"robot-{k % 8}", x=x, y=HEIGHT + 4, width=12, height=12, rx=2)
            + element("text", escape(one.name), x=x + 18, y=HEIGHT + 14)
        )
        x += 34 + 6.6 * len(one.name)
    ground = element("rect", fill="#fff", width=WIDTH, height=HEIGHT + 26)
    return element(
        "svg",
        f"<style>{_STYLE}{inks}</style>{ground}{bars(groups, series, unit)}{''.join(keys)}",
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {WIDTH} {HEIGHT + 26}",
        width=WIDTH,
        height=HEIGHT + 26,
    )


def _bar(
    name: str,
    group: str,
    value: Interval,
    index: int,
    *,
    x: float,
    width: float,
    y: Callable[[float], float],
) -> str:
    base = y(0.0)
    text = f"{name}, {group}: {value.mean:.0f} ({value.low:.0f} to {value.high:.0f})"
    box = element(
        "rect",
        title(text),
        class_=f"robot-{index % 8}",
        x=x - width / 2,
        y=y(value.mean),
        width=width,
        height=base - y(value.mean),
        rx=2,
    )
    error = element(
        "path",
        class_="error",
        d=f"M{x:.1f} {y(value.low):.1f}V{y(value.high):.1f}"
        f"M{x - 4:.1f} {y(value.low):.1f}h8M{x - 4:.1f} {y(value.high):.1f}h8",
    )
    return box + error


def _grid(top: float, y: Callable[[float], float]) -> str:
    lines = []
    for k in range(5):
        value = top * k / 4
        lines.append(
            element("line", class_="grid", x1=LEFT, x2=WIDTH - 8, y1=y(value), y2=y(value))
        )
        lines.append(element("text", f"{value:g}", class_="tick", x=LEFT - 8, y=y(value) + 4))
    return "".join(lines)


def _round_up(value: float) -> float:
    """The next number whose quarters are short: 1, 1.2, 1.6, 2, ... times a power of ten."""
    power = 1.0
    while power * 10 <= value:
        power *= 10
    while power > value:
        power /= 10
    return next(step * power for step in _STEPS if step * power >= value)
