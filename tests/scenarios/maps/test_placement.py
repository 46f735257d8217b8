"""Targets stand free, blockades close what they cross, and the sealed share is what it says."""

import numpy as np
import pytest

from scenarios.maps import hospital
from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.free_space import closed, component_at, components
from scenarios.maps.placement import PlacementParameters, place, sealed_fraction
from scenarios.maps.rooms import open_between


@pytest.mark.parametrize("seed", range(1, 4))
def test_hospital_seals_between_a_third_and_a_half(seed: int) -> None:
    plan = hospital.draw(seed)
    placement = place(plan, seed)
    assert len(placement.targets) == 15
    assert len(placement.blockades) == 18
    assert 0.3 <= placement.sealed_fraction <= 0.5


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_clearing_everything_reaches_everything(seed: int) -> None:
    plan = hospital.draw(seed)
    labels = components(plan.cells(), plan.resolution_m, 0.3)
    for target in place(plan, seed).targets:
        assert component_at(labels, plan.resolution_m, target.position_m) == 1


def two_rooms() -> FloorPlan:
    plan = FloorPlan("two rooms", width=60, height=30, resolution_m=0.2)
    hall = plan.add("corridor", Rectangle(2, 2, 58, 14))
    for x in (2, 31):
        room = plan.add("room", Rectangle(x, 15, x + 27, 28))
        open_between(plan, hall, room, 7, None)
    return plan


def test_sealed_fraction_by_hand() -> None:
    plan = two_rooms()
    cells = plan.cells()
    targets = [(3.1, 4.1), (9.1, 4.1)]
    left, right = (plan.across(opening) for opening in plan.openings)

    def share(*segments: tuple[tuple[float, float], tuple[float, float]]) -> float:
        return sealed_fraction(cells, 0.2, targets, list(segments), 0.3)

    assert share() == 0.0
    assert share(left) == 0.5
    assert share(left, right) == 1.0


def test_a_closed_door_leaves_no_diagonal_way() -> None:
    plan = two_rooms()
    cells = closed(plan.cells(), 0.2, [plan.across(plan.openings[0])])
    labels = components(cells, 0.2, 0.0)
    assert component_at(labels, 0.2, (3.1, 4.1)) != component_at(labels, 0.2, (3.1, 1.1))


def test_clearing_takes_longer_for_larger_blockades() -> None:
    for blockade in place(hospital.draw(1), 1).blockades:
        assert blockade.clear_duration_s == pytest.approx(12.0 * blockade.length_m, abs=0.1)


def test_too_few_rooms_is_said() -> None:
    with pytest.raises(ValueError, match="2 rooms for 15 targets"):
        place(two_rooms(), 1)


def test_same_seed_same_places() -> None:
    first, second = place(two_rooms(), 3, SMALL), place(two_rooms(), 3, SMALL)
    assert first == second
    assert np.isclose(first.sealed_fraction, 0.5)


SMALL = PlacementParameters(targets=2, blockades=1)
