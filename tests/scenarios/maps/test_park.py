"""The park that comes with marsupial: surveyed by laser, safe for carriers, open for rovers."""

from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage

from scenarios.maps import park
from scenarios.scenario_file import read_scenario
from simulator.occupancy_grid import OccupancyGrid, read_map_server
from simulator.vegetation.simulation.remission_model import Material

MAP = Path(park.__file__).parent / "park" / "park.yaml"
SCENARIO = Path(park.__file__).parents[1] / "marsupial" / "park.toml"


@pytest.fixture(scope="module")
def grid() -> OccupancyGrid:
    return read_map_server(MAP)


def centres(grid: OccupancyGrid, chosen: np.ndarray) -> np.ndarray:
    rows, columns = np.nonzero(chosen)
    return (np.column_stack([columns, rows]) + 0.5) * grid.resolution_m


def test_wherever_a_carrier_may_be_it_touches_no_grass(grid: OccupancyGrid) -> None:
    """Against the truth that the survey's classifier never saw."""
    allowed = (grid.cells == 0) & ~grid.forbidden(("paved",))
    touched = park.park(3).world.touched(centres(grid, allowed), park.CARRIER_RADIUS_M)
    assert allowed.sum() > 4000
    assert set(np.unique(touched)) <= {Material.ASPHALT, Material.LIGHT_TILES}


def test_grass_is_where_it_is(grid: OccupancyGrid) -> None:
    assert grid.terrain is not None
    grass = (grid.cells == 0) & (grid.terrain == grid.terrain_classes.index("vegetation"))
    material = park.park(3).world.material_at(centres(grid, grass))
    assert np.isin(material, [Material.LAWN, Material.GRAVEL]).mean() > 0.97


def test_targets_lie_on_both_and_rovers_reach_them_all(grid: OccupancyGrid) -> None:
    targets = np.array([target.position_m for target in read_scenario(SCENARIO).targets])
    assert len(targets) == 12
    material = park.park(3).world.material_at(targets)
    assert (material == Material.LAWN).sum() >= 6
    assert (material == Material.ASPHALT).sum() >= 3
    free = ndimage.distance_transform_edt(grid.cells == 0) * grid.resolution_m > 0.4
    pieces, _ = ndimage.label(free)
    cells = np.floor(targets / grid.resolution_m).astype(int)
    assert len(np.unique(pieces[cells[:, 1], cells[:, 0]])) == 1


@pytest.mark.slow
def test_a_survey_repeats_to_the_byte(tmp_path: Path) -> None:
    park.write_survey(park.survey(3), tmp_path, "park")
    for name in ("park.yaml", "park.pgm", "park_terrain.pgm", "park.toml"):
        assert (tmp_path / name).read_bytes() == (MAP.parent / name).read_bytes()
