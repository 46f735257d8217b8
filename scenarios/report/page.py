"""Puts the report of a mission together: one HTML file that needs nothing beside itself."""

from __future__ import annotations

import json
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from scenarios.mission_record import MissionRecord
from scenarios.report import tables
from scenarios.report.gantt import gantt
from scenarios.report.map_figure import map_figure, thinned


class Ground(Protocol):
    """The map that a report draws."""

    @property
    def cells(self) -> NDArray[np.int8]:
        """`(height, width)`, row 0 at the bottom"""

    @property
    def resolution_m(self) -> float:
        """Width of a cell."""

    @property
    def origin_m(self) -> tuple[float, float]:
        """Lower left corner of cell (0, 0)."""


def write_report(path: Path, record: MissionRecord, composition: Ground) -> Path:
    """Writes the report and returns its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page(record, composition), encoding="utf-8")
    return path


def page(record: MissionRecord, composition: Ground) -> str:
    """The HTML of the report."""
    room = files("scenarios.report")
    style = room.joinpath("style.css").read_text(encoding="utf-8")
    player = room.joinpath("player.js").read_text(encoding="utf-8")
    figure = map_figure(record, composition.cells, composition.resolution_m, composition.origin_m)
    state = "good" if record.completed else "bad"
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{escape(record.scenario)}: mission report</title>
<style>
{style}</style>
</head>
<body>
<main>
<header>
<h1>{escape(record.scenario)} <span class="status {state}">{escape(record.status)}</span></h1>
<p>{_sentence(record)} {_hidden(record)}</p>
</header>
{tables.headline(record)}
<section>
<h2>Driven paths</h2>
<div class="player" hidden>
<button type="button" id="play" aria-label="play">▶</button>
<input type="range" id="time" min="0" max="{record.duration_s:.1f}" step="0.5"
 value="{record.duration_s:.1f}" aria-label="mission time">
<output id="clock"></output>
</div>
{figure}
{_legend(record)}
</section>
<section>
<h2>Executed and planned</h2>
<p class="note">Upper bars: what each robot did. Lower bars: the plan in force at the time of the
player (at first the first plan). Triangles: decisions; point at one for its reason.</p>
{gantt(record)}
<ul class="legend"><li><i class="key explore"></i>drive to a target</li>
<li><i class="key move"></i>other drive</li><li><i class="key clear"></i>clear a blockade</li>
<li><i class="key planned"></i>planned</li>
<li><i class="key cause"></i>decision for a blockade just seen</li></ul>
</section>
<section class="columns">
<div><h2>Robots</h2>{tables.robots(record)}</div>
</section>
<section class="columns two">
<div><h2>Targets</h2>{tables.targets(record)}</div>
<div><h2>Blockades</h2>{tables.blockades(record)}</div>
</section>
<section>
<h2>Decisions</h2>
{tables.decisions(record)}
</section>
<footer>marsupial {escape(record.version)}, strategy {escape(record.strategy)},
domain {escape(record.domain)}, {_source(record)}</footer>
</main>
<script type="application/json" id="mission">{_moving(record, composition)}</script>
<script>
{player}</script>
</body>
</html>
"""


def _sentence(record: MissionRecord) -> str:
    counts: dict[str, int] = {}
    for robot in record.robots:
        counts[robot.type] = counts.get(robot.type, 0) + 1
    team = " and ".join(f"{n} {kind}{'s' if n > 1 else ''}" for kind, n in counts.items())
    reason = f" ({record.status_reason})" if record.status_reason and not record.completed else ""
    width, height = record.map_size_m
    return escape(
        f"{team} in a building of {width:.0f} x {height:.0f} m{reason}, "
        f"coordinated by the strategy “{record.strategy}”."
    ).capitalize()


def _hidden(record: MissionRecord) -> str:
    if record.mission is not None:
        return "What is shown is what the service knew."
    return f"{record.sealed_fraction:.0%} of the targets lay behind blockades that nobody knew of."


def _source(record: MissionRecord) -> str:
    if record.mission is not None:
        return f"from the log of mission {escape(record.mission)}"
    return f"seed {record.seed}, computed in {record.wall_s:.1f} s"


def _legend(record: MissionRecord) -> str:
    robots = "".join(
        f'<li><i class="key line robot-{k % 8}"></i>{escape(robot.id)}</li>'
        for k, robot in enumerate(record.robots)
    )
    return (
        f'<ul class="legend">{robots}'
        '<li><i class="key target"></i>target, in the colour of its visitor</li>'
        '<li><i class="key blockade cleared"></i>blockade cleared</li>'
        '<li><i class="key blockade seen"></i>met, not cleared</li>'
        '<li><i class="key blockade unseen"></i>never met</li></ul>'
    )


def _moving(record: MissionRecord, composition: Ground) -> str:
    """What the player needs: trails in the figure's coordinates."""
    height_m = composition.cells.shape[0] * composition.resolution_m
    x0, y0 = composition.origin_m
    trails = [
        [[round(t, 1), round(x - x0, 2), round(height_m - (y - y0), 2)] for t, x, y in kept]
        for kept in (_timed(robot.trail) for robot in record.robots)
    ]
    return json.dumps({"end": record.duration_s, "trails": trails}, separators=(",", ":"))


def _timed(
    trail: tuple[tuple[float, float, float], ...],
) -> list[tuple[float, float, float]]:
    """A thinned trail that keeps the moment at which a robot sets off again after standing."""
    kept = thinned(trail)
    times = [sample[0] for sample in trail]
    result: list[tuple[float, float, float]] = []
    for sample in kept:
        if result and sample[0] - result[-1][0] > 2.0:
            before = trail[max(0, times.index(sample[0]) - 1)]
            if before[0] > result[-1][0]:
                result.append(before)
        result.append(sample)
    return result
