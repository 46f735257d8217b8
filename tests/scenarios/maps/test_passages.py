"""Doors are found by their width, and buildings without a plan get the same kind of mission."""

from pathlib import Path
from random import Random

import numpy as np
import pytest

import scenarios
from scenarios.composition import map_cells
from scenarios.maps.files import annotations_toml
from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.passages import find_passages, place_in_building
from scenarios.maps.rooms import open_between
from scenarios.scenario_file import ScenarioFileError, read_scenario

ROOM = Path(scenarios.__file__).parent


def test_the_one_door_is_found_where_it_is() -> None:
    plan = FloorPlan("two rooms", width=70, height=40, resolution_m=0.2)
    west = plan.add("room", Rectangle(2, 2, 32, 38))
    east = plan.add("room", Rectangle(33, 2, 68, 38))
    open_between(plan, west, east, 6, None)
    (door,) = plan.openings
    found = find_passages(
        plan.cells(), 0.2, clearance_m=0.3, widest_m=3.0, tries=3000, random=Random(1)
    )
    assert [passage.segment_m for passage in found] == [plan.across(door)]
    assert found[0].width_m == pytest.approx(1.2)
    # The smaller room lies behind it: 30 x 36 cells without the border that a robot cannot reach.
    assert found[0].pocket_m2 == pytest.approx(30 * 36 * 0.04, rel=0.15)


def test_real_hospital_annotations_are_what_the_generator_places(tmp_path: Path) -> None:
    try:
        scenario = read_scenario(ROOM / "disaster" / "hospital_stage.toml")
    except ScenarioFileError as missing:
        pytest.skip(f"needs the drawing of ../shared/data: {missing}")
    cells = map_cells(scenario, tmp_path)
    placement = place_in_building(cells, 0.2, seed=1)
    file = ROOM / "maps" / "hospital_stage" / "hospital_stage.toml"
    assert annotations_toml(placement) == file.read_text(encoding="utf-8")
    assert 0.3 <= placement.sealed_fraction <= 0.5


def test_missing_drawing_is_one_sentence(tmp_path: Path) -> None:
    text = (ROOM / "disaster" / "hospital_stage.toml").read_text(encoding="utf-8")
    path = tmp_path / "stage.toml"
    text = text.replace("../maps/hospital_stage/", f"{ROOM}/maps/hospital_stage/")
    path.write_text(text.replace("hospital.png", "nowhere.png"), encoding="utf-8")
    with pytest.raises(ScenarioFileError, match=r"map\.image: .*nowhere\.png is not there"):
        read_scenario(path)


def test_a_floor_without_passages_is_said() -> None:
    hall = FloorPlan("hall", width=60, height=60, resolution_m=0.2)
    hall.add("room", Rectangle(2, 2, 58, 58))
    with pytest.raises(ValueError, match="found 0 of 18 passages"):
        place_in_building(np.asarray(hall.cells()), 0.2, seed=1)
