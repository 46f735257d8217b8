"""Real buildings from ../shared/data: doorways found, and explored to the last room."""

from pathlib import Path

import pytest

from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import Building, read_carmen_map, scanned
from scenarios.exploration.doorways import score
from scenarios.exploration.one_run import row_of
from scenarios.maps.building_image import sample
from scenarios.maps.floor_plan import Segment
from service.coordination.segmentation.segmentation import SegmentationParameters

DATA = Path(__file__).parents[4] / "shared" / "data"
HOSPITAL = DATA / "stage_maps" / "hospital_section.png"
FREIBURG = DATA / "carmen" / "freiburg-079-map05.png"

HOSPITAL_DOORWAYS_M: tuple[Segment, ...] = (
    ((3.95, 13.3), (4.65, 13.3)),
    ((5.66, 13.3), (7.6, 13.3)),
    ((7.85, 13.3), (9.75, 13.3)),
    ((10.85, 13.3), (12.8, 13.3)),
    ((13.05, 13.3), (14.9, 13.3)),
    ((16.05, 13.3), (17.6, 13.3)),
    ((20.65, 13.3), (21.4, 13.3)),
    ((26.8, 13.3), (28.2, 13.3)),
    ((30.8, 13.3), (31.6, 13.3)),
    ((32.65, 13.3), (33.45, 13.3)),
    ((36.05, 13.3), (36.9, 13.3)),
    ((37.75, 13.3), (38.5, 13.3)),
    ((17.3, 11.0), (17.9, 11.0)),
    ((15.3, 11.45), (15.3, 12.95)),
    ((31.0, 11.0), (31.8, 11.0)),
    ((33.5, 11.0), (34.3, 11.0)),
    ((35.9, 11.0), (36.7, 11.0)),
    ((38.4, 11.0), (39.3, 11.0)),
    ((3.8, 8.35), (4.65, 8.35)),
    ((8.1, 6.6), (9.0, 6.6)),
    ((12.0, 6.6), (12.9, 6.6)),
    ((13.3, 6.6), (14.2, 6.6)),
    ((14.5, 9.39), (14.5, 10.43)),
    ((32.7, 6.75), (33.7, 6.75)),
    ((36.5, 6.75), (37.3, 6.75)),
    ((38.0, 6.75), (38.7, 6.75)),
    ((22.95, 3.2), (23.75, 3.2)),
)
"""read off the drawing, to a tenth of a metre or so"""


def hospital_section() -> Building:
    if not HOSPITAL.is_file():
        pytest.skip("the map of a hospital section is not in ../shared/data/stage_maps")
    cells = sample(HOSPITAL, (40.0, 18.0), 0.1, (10.0, 12.0))
    return scanned("hospital section", cells, 0.1, HOSPITAL_DOORWAYS_M)


def building_079() -> Building:
    if not FREIBURG.is_file():
        pytest.skip("the map of Freiburg's building 079 is not in ../shared/data/carmen")
    cells = read_carmen_map(FREIBURG, 0.05, coarsened_to_m=0.1)
    return scanned("building 079", cells, 0.1)


def test_doorways_of_a_hospital_are_found() -> None:
    building = hospital_section()
    found = score(
        building.truth.cells, 0.1, building.doorways_m, SegmentationParameters(criterion="minima")
    )
    assert found.doorways == len(HOSPITAL_DOORWAYS_M)
    assert found.recall >= 0.85


@pytest.mark.slow
@pytest.mark.parametrize("arm", ["nearest", "segments"])
@pytest.mark.parametrize("building", [hospital_section, building_079])
def test_real_buildings_are_explored(building: object, arm: str) -> None:
    assert callable(building)
    there: Building = building()
    row = row_of(there, 4, 1, ARMS[arm](there), strategy_name=arm)
    assert row["status"] == "completed"
    assert row["known_share"] > 0.95
