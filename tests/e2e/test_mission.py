"""A mission from start to end: scenario, service, planner, simulated fleet, and back."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import scenarios
from scenarios.mission_record import MissionRecord

DISASTER = Path(scenarios.__file__).parent / "disaster"
HOSPITAL = DISASTER / "hospital.toml"
Mission = Callable[..., MissionRecord]


def assert_sound(record: MissionRecord) -> None:
    """What has to hold for every mission that completes."""
    assert record.completed, record.status_reason
    assert record.targets_left == 0
    assert record.replans_for_blockades >= 1
    assert record.wall_collisions == 0
    assert record.blockade_crossings == 0
    for blockade in record.blockades:
        if blockade.cleared_at_s is not None:
            assert blockade.seen_at_s is not None
            assert blockade.seen_at_s + blockade.clear_duration_s <= blockade.cleared_at_s + 1.0


def test_sealed_target_is_reached_after_clearing(ward: Path, mission: Mission) -> None:
    record = mission(ward)
    assert_sound(record)
    assert record.sealed_fraction == pytest.approx(1 / 3)
    assert record.plans_accepted == len(record.plans)
    (blockade,) = record.blockades
    (sealed,) = [target for target in record.targets if target.id == "target_2"]
    assert blockade.cleared_by == "clearer_1"
    assert blockade.cleared_at_s is not None
    assert sealed.visited_at_s is not None
    assert sealed.visited_at_s > blockade.cleared_at_s
    assert {target.visited_by for target in record.targets} == {"explorer_1"}


def test_baseline_completes_too(ward: Path, mission: Mission) -> None:
    assert_sound(mission(ward, strategy="hungarian"))


def test_a_seed_repeats_to_the_bit(ward: Path, mission: Mission) -> None:
    """Node-limited planning and simulated time: nothing depends on how fast the machine is."""
    one, other = (replace(mission(ward, seed=3), wall_s=0.0, planning_s=0.0) for _ in range(2))
    assert one == other


@pytest.mark.slow
def test_hospital_mission_of_the_demo(mission: Mission) -> None:
    record = mission(HOSPITAL, strategy="planner")
    assert_sound(record)
    assert len(record.targets) == 15
    assert record.robot_collisions == 0
    assert record.plans_accepted > 0
    reasons = {decision.revision: decision.reason for decision in record.decisions}
    for plan in record.plans:
        # A replan without a plan in time falls back to one-step orders, and says so.
        assert plan.validated or "; instead " in reasons[plan.revision]


@pytest.mark.slow
def test_a_hundred_robots_do_not_stand_in_each_others_way_for_ever(mission: Mission) -> None:
    record = mission(DISASTER / "stress.toml")
    assert_sound(record)
    assert record.robot_collisions == 0
