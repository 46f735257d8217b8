"""Real buildings from ../shared/data: doorways found, and explored to the last room."""

from pathlib import Path

import pytest

from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import Building
from scenarios.exploration.doorways import score
from scenarios.exploration.one_run import row_of
from scenarios.exploration.real_buildings import (
    FREIBURG,
    HOSPITAL,
    HOSPITAL_DOORWAYS_M,
    building_079,
    hospital_section,
)
from service.coordination.segmentation.segmentation import SegmentationParameters

DATA = Path(__file__).parents[4] / "shared" / "data"


def hospital() -> Building:
    if not (DATA / HOSPITAL).is_file():
        pytest.skip("the map of a hospital section is not in ../shared/data/stage_maps")
    return hospital_section(DATA)


def freiburg() -> Building:
    if not (DATA / FREIBURG).is_file():
        pytest.skip("the map of Freiburg's building 079 is not in ../shared/data/carmen")
    return building_079(DATA)


def test_doorways_of_a_hospital_are_found() -> None:
    building = hospital()
    found = score(
        building.truth.cells, 0.1, building.doorways_m, SegmentationParameters(criterion="minima")
    )
    assert found.doorways == len(HOSPITAL_DOORWAYS_M)
    assert found.recall >= 0.85


@pytest.mark.slow
@pytest.mark.parametrize("arm", ["nearest", "segments"])
@pytest.mark.parametrize("building", [hospital, freiburg])
def test_real_buildings_are_explored(building: object, arm: str) -> None:
    assert callable(building)
    there: Building = building()
    row = row_of(there, 4, 1, ARMS[arm](there), strategy_name=arm)
    assert row["status"] == "completed"
    assert row["known_share"] > 0.95
