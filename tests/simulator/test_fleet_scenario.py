"""A scenario that contradicts itself is refused with a sentence that says where."""

from pathlib import Path
from typing import Any

import pytest

from simulator.fleet_scenario import (
    FleetScenario,
    HiddenBlockade,
    RobotStart,
    RobotType,
    ScenarioError,
)


def scenario(**changes: Any) -> FleetScenario:
    fields: dict[str, Any] = {
        "name": "room",
        "map_path": Path("room.yaml"),
        "robot_types": (RobotType("explorer"), RobotType("carrier", capacity=1)),
        "robots": (RobotStart("explorer_1", "explorer", (1.0, 1.0, 0.0)),),
    }
    return FleetScenario(**(fields | changes))


def test_type_of_finds_the_type_of_a_robot() -> None:
    fleet = scenario()
    assert fleet.type_of(fleet.robots[0]).name == "explorer"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"robots": ()}, "at least one robot"),
        ({"robots": (RobotStart("a", "boat", (0.0, 0.0, 0.0)),)}, "unknown type 'boat'"),
        ({"robots": (RobotStart("a", "explorer", (0.0, 0.0, 0.0)),) * 2}, "two robots"),
        ({"robots": (RobotStart("a", "explorer", (0.0, 0.0, 0.0), "ghost"),)}, "'ghost'"),
        (
            {
                "robots": (
                    RobotStart("c", "carrier", (0.0, 0.0, 0.0)),
                    RobotStart("a", "explorer", (0.0, 0.0, 0.0), "c"),
                    RobotStart("b", "explorer", (0.0, 0.0, 0.0), "c"),
                )
            },
            "capacity 1",
        ),
        ({"blockades": (HiddenBlockade("b", ((1.0, 1.0), (1.0, 1.0)), 5.0),)}, "two different"),
    ],
)
def test_contradictions_are_named(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        scenario(**changes)


def test_a_type_needs_a_body() -> None:
    with pytest.raises(ScenarioError, match="radius_m must be positive"):
        RobotType("ghost", radius_m=0.0)
