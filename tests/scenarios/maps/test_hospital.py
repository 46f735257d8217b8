"""The hospital map: the repository holds what the generator draws, and the floor hangs together."""

from pathlib import Path

import numpy as np
import pytest

from scenarios.maps import hospital
from scenarios.maps.__main__ import draw
from scenarios.maps.floor_plan import FREE
from scenarios.maps.free_space import component_at, components

FOLDER = Path(hospital.__file__).parent / "hospital"


@pytest.mark.parametrize("file", ["hospital.pgm", "hospital.yaml", "hospital.toml"])
def test_repository_holds_what_the_generator_draws(tmp_path: Path, file: str) -> None:
    draw("hospital", 1, tmp_path)
    assert (tmp_path / file).read_bytes() == (FOLDER / file).read_bytes()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_every_room_is_reached_when_nothing_is_blocked(seed: int) -> None:
    plan = hospital.draw(seed)
    cells = plan.cells()
    labels = components(cells, plan.resolution_m, 0.3)
    for space in plan.spaces:
        box = space.interior
        middle = plan.metres((box.x0 + box.x1) // 2 + 0.5, (box.y0 + box.y1) // 2 + 0.5)
        assert component_at(labels, plan.resolution_m, middle) == 1
    assert len([space for space in plan.spaces if space.kind == "room"]) > 60


def test_the_floor_is_closed() -> None:
    """No free cell touches the outside: a robot cannot leave, nor see out of the building."""
    free = np.pad(hospital.draw(1).cells(), 1, constant_values=-1)
    for axis in (0, 1):
        for shift in (-1, 1):
            beside = np.roll(free, shift, axis)
            assert not ((free == FREE) & (beside == -1)).any()


def test_seeds_draw_different_floors() -> None:
    assert (hospital.draw(1).cells() != hospital.draw(2).cells()).any()
