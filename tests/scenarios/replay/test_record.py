"""The record of a mission from its events says what the service said."""

from itertools import pairwise
from typing import Any
from xml.etree import ElementTree

from scenarios.replay.log import events_of
from scenarios.replay.record import moments, record_of
from scenarios.report.page import page

Told = tuple[str, dict[str, Any]]


def test_the_record_agrees_with_the_service(told: Told) -> None:
    url, mission = told
    record, ground = record_of(events_of("latest", db=url))
    assert record.mission == mission["id"]
    assert record.status == "completed"
    assert record.duration_s == mission["time_s"]
    assert record.replans == mission["replans"]
    assert [(t.id, t.visited_by, t.visited_at_s) for t in record.targets] == [
        (t["id"], t["visited_by"], t["visited_at_s"]) for t in mission["targets"]
    ]
    assert {b.id: b.cleared_by for b in record.blockades} == {
        b["id"]: b["cleared_by"] for b in mission["blockades"]
    }
    assert [d.reason for d in record.decisions] == [d["reason"] for d in mission["decisions"]]
    assert record.plans[-1].revision <= mission["revision"]
    assert ground.cells.shape == (9, 20)


def test_robots_do_what_they_were_told_and_one_thing_at_a_time(told: Told) -> None:
    record, _ = record_of(events_of("latest", db=told[0]))
    explorer, clearer = record.robots
    assert {a.location for a in explorer.activities if a.kind == "explore"} == {
        "target_1",
        "target_2",
        "target_3",
    }
    assert [a.location for a in clearer.activities if a.kind == "clear"] != []
    for robot in record.robots:
        assert robot.distance_m > 5.0
        for before, after in pairwise(robot.activities):
            assert before.end_s <= after.start_s
        times = [time_s for time_s, _, _ in robot.trail]
        assert times == sorted(times)


def test_every_decision_is_told_once_at_its_moment(told: Told) -> None:
    url, mission = told
    reasons = [d.reason for m in moments(events_of("latest", db=url)) for d in m.decisions]
    assert reasons == [d["reason"] for d in mission["decisions"]]


def test_the_page_needs_nothing_beside_itself(told: Told) -> None:
    html = page(*record_of(events_of("latest", db=told[0])))
    for outside in ("http://", "https://", 'src="', "@import", "url(h"):
        assert outside not in html
    assert "collisions" not in html
    assert f"from the log of mission {told[1]['id']}" in html
    svg = html[html.index("<svg") : html.index("</svg>") + 6]
    assert len(ElementTree.fromstring(svg).findall(".//polyline")) == 2
