from pathlib import Path

import numpy as np

from simulator.occupancy_grid import OccupancyGrid, read_map_server
from simulator.slam.map_files import write_map_server


def test_a_map_reads_back(tmp_path: Path) -> None:
    cells = np.array([[0, 100, -1], [-1, 0, 100]], dtype=np.int8)
    write_map_server(OccupancyGrid(cells, 0.1, (-3.5, 2.0)), tmp_path / "map.yaml")
    again = read_map_server(tmp_path / "map.yaml")
    assert np.array_equal(again.cells, cells)
    assert again.origin_m == (-3.5, 2.0)
    assert again.resolution_m == 0.1
