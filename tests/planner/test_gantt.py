"""Gantt charts."""

from xml.etree import ElementTree

import pytest

from planner import Plan, Step, gantt

PLAN = Plan(
    (
        Step(0.0, "drive", ("robot_10", "a", "b<c"), 5.0),
        Step(0.0, "drive", ("robot_2", "b", "c"), 7.5),
        Step(2.0, "carry", ("robot_2", "box"), 1.0),
        Step(7.5, "ring", (), None),
    ),
    "d",
    "p",
)
SVG = "{http://www.w3.org/2000/svg}"


def test_a_lane_for_each_first_argument_in_natural_order() -> None:
    assert list(gantt.lanes(PLAN)) == ["ring", "robot_2", "robot_10"]


def test_bars_that_overlap_in_time_get_rows() -> None:
    rows = gantt.rows(gantt.lanes(PLAN)["robot_2"])
    assert [(row, step.action) for row, step in rows] == [(0, "drive"), (1, "carry")]


def test_the_drawing_is_valid_and_to_scale() -> None:
    root = ElementTree.fromstring(gantt.svg(PLAN))
    bars = {group[0].text: group[1] for group in root.iter(f"{SVG}g")}
    assert len(bars) == len(PLAN)
    drive = bars["0 s: (drive robot_2 b c) [7.5 s]"]
    carry = bars["2 s: (carry robot_2 box) [1 s]"]
    scale = float(drive.attrib["width"]) / 7.5
    assert float(carry.attrib["width"]) == pytest.approx(scale, abs=0.1)
    assert float(carry.attrib["x"]) - float(drive.attrib["x"]) == pytest.approx(2 * scale, abs=0.1)
    assert "0 s: (drive robot_10 a b<c) [5 s]" in bars


@pytest.mark.parametrize(("span", "distance"), [(7.5, 1), (100, 10), (0.03, 0.005), (0, 1)])
def test_ticks_are_round_numbers(span: float, distance: float) -> None:
    assert gantt.tick_distance(span) == pytest.approx(distance)


def test_the_page_stands_alone() -> None:
    page = gantt.html(PLAN)
    assert page.startswith("<!doctype html>")
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "")
    assert "7.500: (ring)" in page


def test_an_empty_plan_can_be_drawn() -> None:
    ElementTree.fromstring(gantt.svg(Plan(())))
