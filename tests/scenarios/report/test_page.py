"""The report is well-formed, needs nothing beside itself and shows what happened."""

import json
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

from scenarios.composition import Composition
from scenarios.mission_record import MissionRecord
from scenarios.report.page import page, write_report


def svgs(html: str) -> list[ElementTree.Element]:
    return [ElementTree.fromstring(text) for text in re.findall(r"<svg.*?</svg>", html, re.DOTALL)]


def test_no_external_asset(record: MissionRecord, composition: Composition) -> None:
    html = page(record, composition)
    assert not re.search(r"""(src|href)\s*=|url\((?!#)|@import|https?://""", html)


def test_names_are_escaped(record: MissionRecord, composition: Composition) -> None:
    html = page(record, composition)
    assert "<odd>" not in html
    assert "small &amp; &lt;odd&gt;" in html


def test_drawings_are_well_formed_and_complete(
    record: MissionRecord, composition: Composition
) -> None:
    drawing, chart = svgs(page(record, composition))
    classes = [node.get("class", "").split()[0] for node in drawing if node.get("class")]
    assert [classes.count(name) for name in ("trail", "target", "blockade", "robot")] == [
        2,
        1,
        1,
        2,
    ]
    bars = [node for node in chart if node.get("class", "").startswith("bar ")]
    assert len(bars) == 3  # waiting is no bar
    plans = [node for node in chart if node.get("class", "").startswith("plan")]
    assert [len(plan.findall("rect")) for plan in plans] == [1, 1]


def test_bars_stand_where_time_says(record: MissionRecord, composition: Composition) -> None:
    _, chart = svgs(page(record, composition))
    left, right = float(chart.get("data-left", "")), float(chart.get("data-right", ""))
    bars = [node for node in chart if node.get("class", "").startswith("bar explore")]
    begin = float(bars[0].get("x", ""))
    assert abs(begin - (left + (right - left) * 22.0 / 40.0)) < 0.1


def test_player_knows_when_a_robot_sets_off(
    record: MissionRecord, composition: Composition
) -> None:
    html = page(record, composition)
    text = re.search(r'id="mission">(.*?)</script>', html)
    assert text is not None
    trail = json.loads(text.group(1))["trails"][0]
    assert trail[:3] == [[0.0, 1.5, 4.5], [22.0, 1.5, 4.5], [26.0, 3.0, 3.5]]


def test_failure_is_shown(record: MissionRecord, composition: Composition) -> None:
    html = page(
        replace(record, status="failed", status_reason="time limit", replans=7), composition
    )
    assert 'class="status bad">failed' in html
    assert "time limit" in html.lower()


def test_written_where_asked(
    record: MissionRecord, composition: Composition, tmp_path: Path
) -> None:
    path = write_report(tmp_path / "deep" / "report.html", record, composition)
    assert path.read_text(encoding="utf-8").startswith("<!doctype html>")
