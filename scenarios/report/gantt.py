"""The Gantt chart as SVG: a swim lane for each robot, what it did above, what was planned below."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

from scenarios.mission_record import Activity, MissionRecord, PlannedStep, PlanRecord
from scenarios.report.map_figure import short
from scenarios.report.markup import clock, element, title

WIDTH, GUTTER, LANE, TOP = 1200, 92, 50, 34
BAR, PLANNED = 24, 11
"""heights of executed and of planned bars"""

_Scale = Callable[[float], float]
"""time [s] to x"""

DRAWN = {"explore", "move", "clear", "dock", "undock", "docked", "failed"}


def gantt(record: MissionRecord) -> str:
    """SVG of the executed mission and of every plan that was in force (the first is shown)."""
    end_s = max(record.duration_s, 1.0)
    height = TOP + LANE * len(record.robots) + 8

    def x(time_s: float) -> float:
        return GUTTER + (WIDTH - GUTTER - 8) * min(max(time_s, 0.0), end_s) / end_s

    lanes = "".join(_lane(record, k, x) for k in range(len(record.robots)))
    plans = "".join(_plan(record, plan, k == 0, x) for k, plan in enumerate(record.plans))
    cursor = element("line", class_="cursor", x1=x(end_s), x2=x(end_s), y1=TOP - 6, y2=height - 6)
    return element(
        "svg",
        _hatches(len(record.robots))
        + _axis(end_s, height, x)
        + _replans(record, x)
        + lanes
        + plans
        + cursor,
        class_="gantt",
        viewBox=f"0 0 {WIDTH} {height}",
        role="img",
        aria_label="Gantt chart of what each robot did and was planned to do",
        data_left=GUTTER,
        data_right=WIDTH - 8,
    )


def tick_s(span_s: float, most: int = 12) -> float:
    """The distance between ticks of a time axis: a round number of seconds or minutes."""
    for step in (5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200):
        if span_s / step <= most:
            return float(step)
    return 14400.0


def _axis(end_s: float, height: float, x: _Scale) -> str:
    step = tick_s(end_s)
    marks = []
    for k in range(int(end_s // step) + 1):
        place = x(k * step)
        marks.append(element("line", class_="grid", x1=place, x2=place, y1=TOP - 6, y2=height - 6))
        marks.append(element("text", clock(k * step), class_="tick", x=place, y=14))
    return "".join(marks)


def _replans(record: MissionRecord, x: _Scale) -> str:
    """A tick on the axis for each decision, with its reason as tooltip."""
    marks = []
    for decision in record.decisions:
        place = x(decision.time_s)
        marks.append(
            element(
                "path",
                title(f"{clock(decision.time_s)} {decision.kind}: {decision.reason}"),
                class_="replan blockade-cause" if decision.for_blockade else "replan",
                d=f"M{place:.1f} {TOP - 5}l-3.5 -8h7z",
            )
        )
    return "".join(marks)


def _lane(record: MissionRecord, index: int, x: _Scale) -> str:
    robot = record.robots[index]
    y = TOP + LANE * index
    name = element("text", escape(robot.id.replace("_", " ")), class_="lane", x=0, y=y + BAR - 6)
    base = element(
        "line", class_="base", x1=x(0), x2=x(record.duration_s), y1=y + BAR / 2, y2=y + BAR / 2
    )
    bars = [_bar(activity, index, y, x) for activity in robot.activities if activity.kind in DRAWN]
    return name + base + "".join(bars)


def _bar(activity: Activity, index: int, y: float, x: _Scale) -> str:
    left, right = x(activity.start_s), x(activity.end_s)
    what = f"{activity.kind} {activity.location or ''}".strip()
    tip = f"{what}, {clock(activity.start_s)} to {clock(activity.end_s)}"
    box = element(
        "rect",
        title(tip),
        class_=f"bar {activity.kind} robot-{index % 8}",
        style=f"fill:url(#hatch-{index})" if activity.kind == "clear" else None,
        x=left,
        y=y,
        width=max(right - left - 1.0, 1.0),
        height=BAR,
        rx=3,
    )
    label = short(activity.location) if activity.location else ""
    if label and right - left > 9 * len(label) + 4:
        middle = (left + right) / 2
        box += element(
            "text", escape(label), class_=f"bar-text {activity.kind}", x=middle, y=y + 16.5
        )
    return box


def _plan(record: MissionRecord, plan: PlanRecord, shown: bool, x: _Scale) -> str:
    lane_of = {name: k for k, robot in enumerate(record.robots) for name in _names(robot.id)}
    boxes = []
    for step in plan.steps:
        for argument in step.arguments:
            lane = lane_of.get(argument)
            if lane is not None and step.start_s < record.duration_s:
                boxes.append(_planned(step, lane, x))
    head = title(f"plan {plan.revision} of {clock(plan.time_s)}")
    return element(
        "g",
        head + "".join(boxes),
        class_="plan shown" if shown else "plan",
        data_from=plan.time_s,
    )


def _planned(step: PlannedStep, lane: int, x: _Scale) -> str:
    left, right = x(step.start_s), x(step.start_s + step.duration_s)
    words = " ".join((step.action, *step.arguments))
    tip = f"planned: {words}, {clock(step.start_s)} to {clock(step.start_s + step.duration_s)}"
    kind = "clear" if step.action.startswith("clear") else "drive"
    return element(
        "rect",
        title(tip),
        class_=f"planned {kind} robot-{lane % 8}",
        x=left,
        y=TOP + LANE * lane + BAR + 4,
        width=max(right - left - 1.0, 1.0),
        height=PLANNED,
        rx=2,
    )


def _names(robot: str) -> tuple[str, str]:
    """A robot's id and how PDDL may spell it."""
    return robot, robot.lower().replace("_", "-")


def _hatches(robots: int) -> str:
    patterns = "".join(
        element(
            "pattern",
            element("rect", class_=f"ground robot-{k % 8}", width=6, height=6)
            + element("path", class_="stripe", d="M-1 7L7 -1M-1 1L1 -1M5 7L7 5"),
            id=f"hatch-{k}",
            width=6,
            height=6,
            patternUnits="userSpaceOnUse",
        )
        for k in range(robots)
    )
    return f"<defs>{patterns}</defs>"
