"""Every generator draws closed floors whose rooms hang together, with enough sealed targets."""

import numpy as np
import pytest

from scenarios.maps.floor_plan import FREE
from scenarios.maps.free_space import component_at, components
from scenarios.maps.generators import GENERATORS
from scenarios.maps.placement import place

RATIOS = {
    "hospital": (4.96, 27.05),
    "power_plant": (2.5, 65.9),
    "office": (4.0, 23.8),
    "maze": (4.0, 10.2),
}
"""sensor range [m] of the scenario, and the thesis's size-to-range ratio (3.6.2, 3.6.5)"""


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("kind", sorted(GENERATORS))
def test_every_space_is_reached_and_nothing_leaks(kind: str, seed: int) -> None:
    plan = GENERATORS[kind][0](seed)
    cells = plan.cells()
    labels = components(cells, plan.resolution_m, 0.3)
    for space in plan.spaces:
        box = space.interior
        inside = labels[box.y0 : box.y1, box.x0 : box.x1]
        assert set(np.unique(inside)) == {0, 1}, space
    outside = np.pad(cells, 1, constant_values=-1)
    free = outside == FREE
    for axis in (0, 1):
        for shift in (-1, 1):
            assert not (free & (np.roll(outside, shift, axis) == -1)).any()


@pytest.mark.parametrize("seed", [3])
@pytest.mark.parametrize("kind", [k for k, (_, p) in sorted(GENERATORS.items()) if p.blockades])
def test_missions_depend_on_clearing(kind: str, seed: int) -> None:
    generator, parameters = GENERATORS[kind]
    plan = generator(seed)
    placement = place(plan, seed, parameters)
    assert len(placement.targets) == parameters.targets
    assert len(placement.blockades) == parameters.blockades
    assert 0.3 <= placement.sealed_fraction <= 0.5
    labels = components(plan.cells(), plan.resolution_m, 0.3)
    assert {
        component_at(labels, plan.resolution_m, target.position_m) for target in placement.targets
    } == {1}


@pytest.mark.parametrize("kind", sorted(RATIOS))
def test_size_to_range_ratio_is_the_thesis_s(kind: str) -> None:
    plan = GENERATORS[kind][0](1)
    range_m, ratio = RATIOS[kind]
    diagonal_m = np.hypot(plan.width, plan.height) * plan.resolution_m
    assert diagonal_m / range_m == pytest.approx(ratio, rel=0.005)
