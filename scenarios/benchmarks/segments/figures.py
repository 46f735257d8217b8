"""Figure 2.8: improvement over the baseline by team size, as a self-contained SVG."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from scenarios.batch.comparison import Comparison
from scenarios.report.markup import element

COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b", "#17becf")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 340, 62, 170, 34, 46


def improvement_figure(title: str, comparisons: Sequence[Comparison]) -> str:
    """Percent of the baseline's time saved, with 95 % intervals; above zero is faster.

    `comparisons` may be of several strategies, all with the same reference.
    """
    teams = sorted({c.team for c in comparisons}, key=_robots)
    arms = list(dict.fromkeys(c.strategy for c in comparisons))
    low = min(0.0, *(100 * c.gain.low for c in comparisons))
    high = max(0.0, *(100 * c.gain.high for c in comparisons))
    step = next(s for s in (2, 5, 10, 20, 50, 100) if (high - low) / s <= 8)
    bottom, top = step * (low // step), step * -(-high // step)

    def y(percent: float) -> float:
        return TOP + (HEIGHT - TOP - BOTTOM) * (top - percent) / max(top - bottom, 1e-9)

    def x(team: str, arm: str) -> float:
        slot = (WIDTH - LEFT - RIGHT) / len(teams)
        offset = (arms.index(arm) - (len(arms) - 1) / 2) * min(14.0, 0.7 * slot / len(arms))
        return LEFT + slot * (teams.index(team) + 0.5) + offset

    drawn = [_text(title, LEFT, 16, anchor="start", size=14)]
    percent = bottom
    while percent <= top + 1e-9:
        bold = abs(percent) < 1e-9
        drawn.append(
            element(
                "line",
                x1=LEFT,
                x2=WIDTH - RIGHT,
                y1=y(percent),
                y2=y(percent),
                stroke="#444" if bold else "#ddd",
            )
        )
        drawn.append(_text(f"{percent:.0f} %", LEFT - 8, y(percent) + 4, anchor="end"))
        percent += step
    for comparison in comparisons:
        colour = COLOURS[arms.index(comparison.strategy) % len(COLOURS)]
        at = x(comparison.team, comparison.strategy)
        share = comparison.gain
        drawn.append(
            element(
                "line",
                x1=at,
                x2=at,
                y1=y(100 * share.low),
                y2=y(100 * share.high),
                stroke=colour,
                stroke_width=2,
            )
        )
        drawn.append(
            element(
                "circle",
                cx=at,
                cy=y(100 * share.mean),
                r=5,
                stroke=colour,
                stroke_width=2,
                fill=colour if comparison.significant else "white",
            )
        )
    drawn += [_text(team, _middle(team, teams), HEIGHT - 24) for team in teams]
    for index, arm in enumerate(arms):
        height = TOP + 16 + 20 * index
        drawn.append(
            element(
                "circle",
                cx=WIDTH - RIGHT + 16,
                cy=height - 4,
                r=5,
                fill=COLOURS[index % len(COLOURS)],
            )
        )
        drawn.append(_text(arm, WIDTH - RIGHT + 28, height, anchor="start"))
    drawn.append(
        _text("filled: significant (Holm over the teams)", WIDTH - RIGHT, HEIGHT - 6, anchor="end")
    )
    return element(
        "svg",
        element("rect", width=WIDTH, height=HEIGHT, fill="white") + "".join(drawn),
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        font_family="sans-serif",
    )


def _middle(team: str, teams: Sequence[str]) -> float:
    return LEFT + (WIDTH - LEFT - RIGHT) / len(teams) * (teams.index(team) + 0.5)


def _robots(team: str) -> int:
    return int(team.split(maxsplit=1)[0])


def _text(text: str, x: float, y: float, *, anchor: str = "middle", size: int = 12) -> str:
    return element("text", escape(text), x=x, y=y, text_anchor=anchor, font_size=size, fill="#222")
