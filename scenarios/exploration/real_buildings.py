"""Real buildings, from maps that are not part of the project."""

from __future__ import annotations

from pathlib import Path

from scenarios.exploration.buildings import Building, read_carmen_map, scanned
from scenarios.maps.building_image import sample
from scenarios.maps.floor_plan import Segment

DATA = Path("../shared/data")
HOSPITAL = Path("stage_maps") / "hospital_section.png"
FREIBURG = Path("carmen") / "freiburg-079-map05.png"
CELL_M = 0.1

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


def hospital_section(folder: Path = DATA) -> Building:
    """Part of a hospital floor of 40 x 18 m, from a drawing; its doorways are labelled."""
    cells = sample(folder / HOSPITAL, (40.0, 18.0), CELL_M, (10.0, 12.0))
    return scanned("hospital section", cells, CELL_M, HOSPITAL_DOORWAYS_M)


def building_079(folder: Path = DATA) -> Building:
    """The office floor of 37 x 14 m in Freiburg that figure 2.8 is about, from a laser log."""
    cells = read_carmen_map(folder / FREIBURG, 0.05, coarsened_to_m=CELL_M)
    return scanned("building 079", cells, CELL_M)
