"""Missions run for the tests: scenario in, record out."""

from collections.abc import Callable
from pathlib import Path

import pytest

import scenarios
from scenarios.maps.files import write_map
from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.rooms import open_between
from scenarios.mission import RunOptions, composed, run
from scenarios.mission_record import MissionRecord

HOSPITAL = Path(scenarios.__file__).parent / "disaster" / "hospital.toml"

WARD = """
name = "ward"
time_limit_s = 900
[map]
file = "ward.yaml"
[robot_types.explorer]
[robot_types.clearer]
[[robots]]
id = "explorer_1"
type = "explorer"
pose = [2.0, 1.5, 0.0]
[[robots]]
id = "clearer_1"
type = "clearer"
pose = [4.0, 1.5, 0.0]
[[targets]]
id = "target_1"
position_m = [3.1, 4.5]
[[targets]]
id = "target_2"
position_m = [15.1, 4.5]
[[targets]]
id = "target_3"
position_m = [21.1, 4.5]
[[blockades]]
id = "blockade_1"
segment_m = [[14.0, 2.9], [16.2, 2.9]]
clear_duration_s = 17.0
[planning]
time_limit_s = 5.0
node_limit = 2000
"""
"""Three rooms on a corridor; the door of the middle one is blocked, and nobody knows."""

Mission = Callable[..., MissionRecord]


@pytest.fixture
def ward(tmp_path: Path) -> Path:
    """The scenario file of three rooms on a corridor of 24 m."""
    plan = FloorPlan("ward", width=120, height=30, resolution_m=0.2)
    hall = plan.add("corridor", Rectangle(2, 2, 118, 14))
    for x in (2, 52, 91):
        room = plan.add("room", Rectangle(x, 15, x + 27 if x == 91 else x + 38, 28))
        open_between(plan, hall, room, 7, None)
    write_map(tmp_path, "ward", plan.cells(), plan.resolution_m)
    (door,) = [plan.across(opening) for opening in plan.openings if opening.joins == (0, 2)]
    text = WARD.replace("[[14.0, 2.9], [16.2, 2.9]]", str([list(end) for end in door]))
    path = tmp_path / "ward.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def mission(tmp_path: Path) -> Mission:
    """Runs a scenario file with the service in this process."""

    def of(scenario: Path, seed: int = 1, strategy: str | None = None) -> MissionRecord:
        options = RunOptions(seed=seed, strategy=strategy, headless=True)
        folder = tmp_path / f"{scenario.stem}-{seed}-{strategy}"
        folder.mkdir(exist_ok=True)
        return run(composed(scenario, options, folder), options, lambda _: None)

    return of
