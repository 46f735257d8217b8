"""Robots part and meet: who shares knowledge with whom, and missions with short radios."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from simulator.contact import Contact
from simulator.fleet_client import FleetClient
from simulator.fleet_scenario import (
    Communication,
    Failure,
    FleetScenario,
    HiddenBlockade,
    RobotStart,
    Target,
)
from simulator.knowledge import Knowledge
from simulator.navigation import Navigation
from simulator.occupancy_grid import read_map_server
from simulator.radio import Radio
from simulator.robot import Robot
from simulator.simulation import Simulation, SimulationResult
from tests.simulator.dispatcher import Dispatcher
from tests.simulator.floors import CLEARER, EXPLORER, TWO_ROOMS, write_floor

BLOCKADE = HiddenBlockade("blockade_1", ((9.5, 3.0), (9.5, 4.0)), 5.0)
HALL = "\n".join(
    [
        "#" * 50,
        *["#" + "." * 48 + "#"] * 3,
        "#" * 24 + "." + "#" * 25,
        *["#" + "." * 48 + "#"] * 3,
        "#" * 50,
    ]
)
"""Two halls of 48 x 3 m, one above the other, and a gap of 1 m between them."""


def team(folder: Path) -> tuple[list[Robot], Contact]:
    robots = [Robot(name, EXPLORER, 2.0 + k, 3.5, 0.0) for k, name in enumerate("abc")]
    navigation = Navigation(read_map_server(write_floor(folder, TWO_ROOMS)))
    return robots, Contact(robots, Knowledge(navigation), Radio(3.0, (1.0, 3.5)))


def test_all_start_out_knowing_the_same(tmp_path: Path) -> None:
    robots, contact = team(tmp_path)
    assert contact.update(robots) == []
    assert contact.linked == {"a", "b", "c"}
    assert all(contact[name] is contact.base for name in "abc")


def test_what_is_learned_apart_is_shared_on_meeting(tmp_path: Path) -> None:
    robots, contact = team(tmp_path)
    robots[2].x = 9.0
    contact.update(robots)
    assert contact.linked == {"a", "b"}
    assert contact["c"] is not contact.base
    contact["c"].sense(BLOCKADE, 1.0)
    assert contact.base.untold == []
    robots[2].x = 4.0
    assert contact.update(robots) == [("a", "b", "c")]
    assert contact.base.untold == ["blockade_1"]
    assert contact["a"] is contact.base


def test_word_is_passed_on_by_somebody_who_was_not_there(tmp_path: Path) -> None:
    robots, contact = team(tmp_path)
    _, b, c = robots
    b.x, c.x = 12.0, 14.0
    contact.update(robots)
    contact["c"].sense(BLOCKADE, 1.0)
    c.x = 18.0
    contact.update(robots)
    b.x = 3.0
    contact.update(robots)
    assert contact.linked == {"a", "b"}
    assert contact.base.untold == ["blockade_1"]
    assert contact.last_linked_m["c"] == (4.0, 3.5)


class Telling(Dispatcher):
    """Notes when the dispatcher hears of a blockade and who has orders for it."""

    def __init__(self) -> None:
        super().__init__()
        self.heard_s: float | None = None

    def take_in(self, report: dict[str, Any]) -> None:
        if report["blockades"] and self.heard_s is None:
            self.heard_s = report["time_s"]
        super().take_in(report)


def halls(folder: Path, **changes: Any) -> FleetScenario:
    """An explorer and a clearer in the lower hall; the gap to the upper one is 24 m away."""
    scenario = FleetScenario(
        name="halls",
        map_path=write_floor(folder, HALL),
        robot_types=(EXPLORER, CLEARER),
        robots=(
            RobotStart("clearer_1", "clearer", (2.0, 2.5, 0.0)),
            RobotStart("explorer_1", "explorer", (4.0, 2.5, 0.0)),
        ),
        targets=(Target("far", (46.0, 1.5)), Target("above", (24.5, 6.5))),
        blockades=(HiddenBlockade("blockade_1", ((24.0, 4.5), (25.0, 4.5)), 5.0),),
        communication=Communication(range_m=10.0),
        time_limit_s=600.0,
    )
    return replace(scenario, **changes)


def run(scenario: FleetScenario) -> tuple[SimulationResult, Telling, Simulation]:
    dispatcher = Telling()
    simulation = Simulation(scenario, FleetClient(dispatcher))
    for _ in simulation.run():
        pass
    assert simulation.result is not None
    return simulation.result, dispatcher, simulation


def test_a_blockade_sensed_out_of_contact_is_acted_upon_only_after_contact(tmp_path: Path) -> None:
    result, dispatcher, _ = run(halls(tmp_path))
    assert result.outcome == "completed"
    sensed_s = result.sensed["blockade_1"]
    # It is sensed from 5 m, 19 m from the base, and told only where the radio reaches.
    assert dispatcher.heard_s is not None
    assert dispatcher.heard_s > sensed_s + 5.0
    clears = [a for a in result.actions if a.kind == "clear" or a.robot == "clearer_1"]
    assert min(action.start_s for action in clears) >= dispatcher.heard_s
    heard_at = result.tracks["explorer_1"]
    then = heard_at[np.searchsorted(heard_at[:, 0], dispatcher.heard_s) - 1]
    assert np.hypot(then[1] - 2.0, then[2] - 2.5) <= 10.0 + 1.0
    everywhere, at_once, _ = run(halls(tmp_path, communication=None))
    assert at_once.heard_s == pytest.approx(everywhere.sensed["blockade_1"], abs=0.1)
    assert everywhere.time_s < result.time_s


def test_nobody_out_of_contact_is_in_a_report(tmp_path: Path) -> None:
    scenario = halls(tmp_path)
    result, dispatcher, _ = run(scenario)
    for report in dispatcher.reports:
        for robot in report["robots"]:
            # Up to half a second passes between a look at who is in contact and the report.
            others = [r["pose"] for r in report["robots"] if r is not robot]
            near = [[2.0, 2.5], *(pose[:2] for pose in others)]
            assert min(np.hypot(x - robot["pose"][0], y - robot["pose"][1]) for x, y in near) < 11.0
    assert any(len(report["robots"]) == 1 for report in dispatcher.reports)
    assert result.contacts.wall == result.contacts.robot == 0


def test_what_was_done_out_of_contact_is_told_with_time_and_place(tmp_path: Path) -> None:
    result, dispatcher, _ = run(halls(tmp_path))
    told = [f for report in dispatcher.reports for f in report["finished"] if "time_s" in f]
    assert told
    far = next(f for f in told if f["position_m"][0] > 40.0)
    assert far["time_s"] == pytest.approx(result.visited["far"], abs=0.1)


def test_the_same_seed_gives_the_same_mission(tmp_path: Path) -> None:
    first, one, _ = run(halls(tmp_path))
    second, other, _ = run(halls(tmp_path))
    assert first.actions == second.actions
    assert all(np.array_equal(first.tracks[r], second.tracks[r]) for r in first.tracks)
    assert one.reports == other.reports


def test_a_robot_that_dies_out_of_contact_is_told_of_by_whoever_finds_it(tmp_path: Path) -> None:
    scenario = halls(tmp_path, blockades=(), targets=(Target("far", (46.0, 1.5)),))
    scenario = replace(
        scenario,
        robots=(*scenario.robots, RobotStart("explorer_2", "explorer", (2.0, 1.4, 0.0))),
        failures=(Failure("explorer_1", 25.0),),
        time_limit_s=200.0,
    )

    class Impatient(Telling):
        """Sends another one when the first has been silent for long."""

        def answer(self, report: dict[str, Any]) -> dict[str, Any]:
            if report["time_s"] > 50.0 and "explorer_1" in self.commands:
                self.commands.pop("explorer_1")
            return super().answer(report)

    dispatcher = Impatient()
    simulation = Simulation(scenario, FleetClient(dispatcher))
    for _ in simulation.run():
        pass
    assert simulation.result is not None
    said = [r["time_s"] for r in dispatcher.reports for b in r["robots"] if b["state"] == "failed"]
    assert said
    assert min(said) > 50.0
    assert simulation.contact.base.dead == {"explorer_1": None}


def test_an_unlimited_radio_changes_nothing(tmp_path: Path) -> None:
    plain, _, _ = run(halls(tmp_path, communication=None))
    wide, _, _ = run(halls(tmp_path, communication=Communication(range_m=1000.0)))
    assert plain.actions == wide.actions
    assert all(np.array_equal(plain.tracks[r], wide.tracks[r]) for r in plain.tracks)
