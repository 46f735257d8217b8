"""What a fleet knows of a building, and the patches that tell the service."""

import base64
import zlib

import numpy as np

from simulator._core import Floor
from simulator.mapping.sensed_map import SensedMap
from simulator.occupancy_grid import OccupancyGrid
from simulator.sensors import Scan


def room() -> OccupancyGrid:
    """A room of 5 x 5 m in walls, nothing known outside."""
    cells = np.full((31, 31), -1, dtype=np.int8)
    cells[2:29, 2:29] = 100
    cells[3:28, 3:28] = 0
    return OccupancyGrid(cells, 0.2, (0.0, 0.0))


def scan_at(x: float, y: float, discs: list[tuple[float, float, float]], range_m: float) -> Scan:
    truth = room()
    floor = Floor(truth.walls(), truth.resolution_m, truth.origin_m)
    ranges_m, _ = floor.scan(x, y, 0.0, range_m, 360, [], discs)
    return Scan("a", 0.0, (x, y, 0.0), range_m, ranges_m, ())


def applied(cells: np.ndarray, patch: dict[str, object]) -> None:  # type: ignore[type-arg]
    height, width = int(str(patch["height"])), int(str(patch["width"]))
    row, column = int(str(patch["row"])), int(str(patch["column"]))
    told = np.frombuffer(zlib.decompress(base64.b64decode(str(patch["cells"]))), dtype=np.int8)
    told = told.reshape(height, width)
    window = cells[row : row + height, column : column + width]
    window[told >= 0] = told[told >= 0]


def test_patches_add_up_to_what_is_known() -> None:
    sensed, service = SensedMap(room()), np.full((31, 31), -1, dtype=np.int8)
    for x, y in ((1.5, 1.5), (3.1, 2.1), (4.5, 4.5)):
        sensed.insert(scan_at(x, y, [], 1.5), [])
        (patch,) = sensed.news()
        applied(service, patch)
        assert (service == sensed.cells()).all()
    assert sensed.news() == []


def test_a_whole_room_is_known_and_right() -> None:
    sensed = SensedMap(room())
    sensed.insert(scan_at(3.1, 3.1, [], 6.0), [])
    assert sensed.known_share() > 0.99
    known = sensed.cells() >= 0
    assert (sensed.cells()[known] == room().cells[known]).mean() > 0.99


def test_team_mates_are_no_walls() -> None:
    mate = (4.3, 3.1, 0.3)
    naive, sensed = SensedMap(room()), SensedMap(room())
    naive.insert(scan_at(3.1, 3.1, [mate], 6.0), [])
    sensed.insert(scan_at(3.1, 3.1, [mate], 6.0), [mate])
    assert (naive.cells()[14:17, 19:22] == 100).any()
    assert not (sensed.cells()[3:28, 3:28] == 100).any()
