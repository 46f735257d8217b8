"""Plans as Gantt charts: one swim lane for each first argument (a robot, usually)."""

from collections.abc import Iterable
from html import escape
from math import floor, log10
from zlib import crc32

from planner.plan import Plan, Step

LANE_HEIGHT = 34
BAR_HEIGHT = 22
LEFT = 130
CHARACTER_WIDTH = 7.1
"""Of the widest usual font at 12 px; labels stay inside their bars."""
WIDTH = 1100
TOP = 44


def lanes(plan: Iterable[Step]) -> dict[str, list[Step]]:
    """Steps by their first argument, lanes in alphabetical order; actions without arguments have
    a lane of their own.
    """
    found: dict[str, list[Step]] = {}
    for step in plan:
        found.setdefault(step.arguments[0] if step.arguments else step.action, []).append(step)
    return {lane: found[lane] for lane in sorted(found, key=_natural)}


def _natural(name: str) -> list[tuple[int, str]]:
    """robot_2 before robot_10."""
    parts: list[tuple[int, str]] = []
    digits = ""
    for character in name + " ":
        if character.isascii() and character.isdigit():
            digits += character
        else:
            if digits:
                parts.append((int(digits), ""))
                digits = ""
            parts.append((-1, character))
    return parts


def rows(steps: list[Step]) -> list[tuple[int, Step]]:
    """Steps of one lane with the row of each, so that bars that overlap in time do not overlap
    on the page.
    """
    ends: list[float] = []
    placed: list[tuple[int, Step]] = []
    for step in sorted(steps, key=lambda one: one.start):
        row = next((index for index, end in enumerate(ends) if end <= step.start), len(ends))
        if row == len(ends):
            ends.append(0.0)
        ends[row] = step.end
        placed.append((row, step))
    return placed


def tick_distance(span: float, ticks: int = 10) -> float:
    """A round distance (1, 2 or 5 times a power of ten) that gives at most `ticks` ticks."""
    if span <= 0:
        return 1.0
    power: float = 10.0 ** floor(log10(span / ticks))
    return next(power * factor for factor in (1, 2, 5, 10) if span / (power * factor) <= ticks)


def colour(action: str) -> str:
    """A colour of its own for every action name, the same in every chart."""
    return f"hsl({crc32(action.encode()) % 360} 55% 68%)"


def svg(plan: Plan, title: str | None = None) -> str:
    """A self-contained SVG drawing; every bar has its step as a tooltip."""
    span = max(plan.makespan, 1e-9)
    scale = (WIDTH - LEFT - 20) / span
    body: list[str] = []
    bars: list[str] = []
    y = TOP
    for lane, steps in lanes(plan).items():
        placed = rows(steps)
        height = LANE_HEIGHT * (1 + max(row for row, _ in placed))
        body.append(f'<rect class="lane" x="0" y="{y}" width="{WIDTH}" height="{height - 2}"/>')
        body.append(f'<text class="name" x="8" y="{y + 21}">{escape(lane)}</text>')
        for row, step in placed:
            bars.append(_bar(step, LEFT + step.start * scale, y + row * LANE_HEIGHT + 5, scale))
        y += height
    distance = tick_distance(span)
    for index in range(int(span / distance + 1e-9) + 1):
        x = LEFT + index * distance * scale
        body.append(f'<line x1="{x:.1f}" y1="{TOP - 6}" x2="{x:.1f}" y2="{y}"/>')
        body.append(f'<text class="tick" x="{x:.1f}" y="{TOP - 12}">{index * distance:g} s</text>')
    heading = title or " / ".join(filter(None, (plan.domain, plan.problem))) or "plan"
    return "\n".join(
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y + 10}" '
            f'role="img" aria-label="{escape(heading)}">',
            f"<style>{STYLE}</style>",
            f'<text class="title" x="8" y="18">{escape(heading)}: '
            f"makespan {plan.makespan:g} s</text>",
            *body,
            *bars,
            "</svg>",
            "",
        )
    )


def _bar(step: Step, x: float, y: float, scale: float) -> str:
    """One step; the label is cut to the width of its bar."""
    width = max((step.duration or 0.0) * scale, 2.0)
    text = " ".join((step.action, *step.arguments[1:]))
    characters = int((width - 8) / CHARACTER_WIDTH)
    label = text if len(text) <= characters else f"{text[: max(characters - 1, 0)]}…"
    duration = "" if step.duration is None else f" [{step.duration:g} s]"
    shown = f'<text x="{x + 4:.1f}" y="{y + 15}">{escape(label)}</text>' if characters > 2 else ""
    return (
        f"<g><title>{step.start:g} s: {escape(str(step))}{duration}</title>"
        f'<rect x="{x:.1f}" y="{y}" width="{width:.1f}" height="{BAR_HEIGHT}" rx="3" '
        f'fill="{colour(step.action)}"/>{shown}</g>'
    )


def html(plan: Plan, title: str | None = None) -> str:
    """A self-contained page with the chart and the plan as text."""
    heading = title or " / ".join(filter(None, (plan.domain, plan.problem))) or "plan"
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{escape(heading)}</title>
<style>
body {{ font-family: system-ui, sans-serif; margin: 1.5rem; }}
pre {{ overflow-x: auto; }}
</style>
</head>
<body>
{svg(plan, title)}<pre>{escape(plan.to_text())}</pre>
</body>
</html>
"""


STYLE = (
    "text{font:12px system-ui,sans-serif;fill:#1b1f24}"
    ".title{font-weight:600;font-size:14px}.name{font-weight:600}.tick{text-anchor:middle;fill:#57606a}"
    ".lane{fill:#f4f6f8}line{stroke:#d0d7de}g rect{stroke:#57606a;stroke-width:.5}"
)
