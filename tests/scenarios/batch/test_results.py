"""The report of a suite shows each map's figure, comparisons and what has to be zero."""

import csv
import re
from pathlib import Path
from xml.etree import ElementTree

from scenarios.batch.comparison import Row
from scenarios.batch.findings import findings
from scenarios.batch.results import markdown, page, write
from scenarios.batch.suite import MapEntry, Suite

SUITE = Suite(
    name="small & odd",
    maps=(MapEntry(name="floor", scenario=Path("f.toml"), figure="figure 3.13, top"),),
    teams=({"clearer": 1, "explorer": 1}, {"clearer": 1, "explorer": 2}),
    strategies=("planner", "hungarian"),
    seeds=4,
)


def rows() -> list[Row]:
    made = []
    for spec in SUITE.runs():
        slow = 1.3 if spec.strategy == "hungarian" else 1.0
        made.append(
            {
                "key": spec.key,
                "map": spec.map_name,
                "map_seed": None,
                "team": spec.team_name,
                "robots": sum(count for _, count in spec.team),
                "seed": spec.seed,
                "strategy": spec.strategy,
                "status": "completed",
                "duration_s": slow * (100.0 + 7 * spec.seed + 3 * spec.seed % 5),
                "wall_collisions": 0,
                "cpu_s": 1.0,
                **{"revision": "abc", "version": "0", "python": "3", "numpy": "2", "pymunk": "7"},
            }
        )
    made[0]["status"] = "stuck"
    return made


def test_page_has_a_figure_a_map_and_no_external_asset() -> None:
    html = page(findings(SUITE, rows()))
    assert not re.search(r"""(src|href)\s*=|url\((?!#)|@import|https?://""", html)
    (chart,) = re.findall(r"<svg.*?</svg>", html, re.DOTALL)
    drawn = ElementTree.fromstring(chart)
    assert len(drawn.findall("rect")) == 4
    assert "figure 3.13, top" in html
    assert "small &amp; odd" in html


def test_failures_are_counted_not_hidden() -> None:
    text = markdown(findings(SUITE, rows()))
    line = next(line for line in text.splitlines() if line.startswith("| planner | 8 |"))
    assert line.split("|")[3:5] == [" 1 ", " 1 "]
    assert "8 of 16 runs" not in text
    assert "16 of 16 runs" in text


def test_without_a_completed_pair_it_says_so() -> None:
    failed = [{**row, "status": "stuck"} for row in rows()]
    text = markdown(findings(SUITE, failed))
    assert "no completed pair" in text
    assert "nan" not in text
    assert "nan" not in page(findings(SUITE, failed))


def test_a_single_pair_has_no_test_and_no_interval(tmp_path: Path) -> None:
    write(findings(SUITE, [row for row in rows() if row["seed"] == 2]), tmp_path)
    lines = (tmp_path / "report.md").read_text(encoding="utf-8").splitlines()
    (line,) = (line for line in lines if line.startswith("| 1 explorer + 1 clearer | hungarian"))
    assert "| 23.1 % | - | - | - |" in line


def test_files_hold_every_row(tmp_path: Path) -> None:
    write(findings(SUITE, rows()), tmp_path)
    with (tmp_path / "runs.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 16
    with (tmp_path / "comparisons.csv").open(encoding="utf-8") as file:
        compared = list(csv.DictReader(file))
    assert [line["team"] for line in compared] == [
        "1 explorer + 1 clearer",
        "2 explorer + 1 clearer",
    ]
    assert float(compared[0]["gain"]) > 0.2
    (drawn,) = tmp_path.glob("*.svg")
    assert drawn.name == "floor_mission_time.svg"
    assert f"]({drawn.name})" in (tmp_path / "report.md").read_text(encoding="utf-8")
    figure = ElementTree.fromstring(drawn.read_text(encoding="utf-8"))
    texts = {text.text for text in figure.iter("{http://www.w3.org/2000/svg}text")}
    assert {"planner", "hungarian", "mission time [s]"} <= texts


def test_explorations_are_compared_by_quality_too() -> None:
    explored = [
        {**row, "area_m2": 500.0, "distance_m": 100.0 if row["strategy"] == "planner" else 125.0}
        for row in rows()
    ]
    found = findings(SUITE, explored)
    quality = [c for c in found.comparisons if c.measure.unit == "m²/m"]
    assert [round(c.gain.mean, 3) for c in quality] == [0.25, 0.25]
    assert "exploration quality" in page(found)
