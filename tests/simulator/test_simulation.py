"""Missions with a small dispatcher instead of the service: what the fleet itself has to get
right."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from simulator.fleet_client import FleetClient
from simulator.fleet_scenario import (
    Failure,
    FleetScenario,
    RobotStart,
    RobotType,
    ScenarioError,
    Target,
)
from simulator.simulation import Simulation, SimulationResult
from tests.simulator.dispatcher import Dispatcher
from tests.simulator.floors import EXPLORER, two_rooms, write_floor

CORRIDOR = """
########################
#####.............######
#####.###########.######
#......................#
########################
"""
"""A corridor one metre wide with a loop, the only place where two robots can pass one another."""


def run(scenario: FleetScenario) -> tuple[SimulationResult, Dispatcher]:
    dispatcher = Dispatcher()
    simulation = Simulation(scenario, FleetClient(dispatcher))
    for _ in simulation.run():
        pass
    assert simulation.result is not None
    return simulation.result, dispatcher


def assert_sound(result: SimulationResult) -> None:
    contacts = result.contacts
    assert (contacts.wall, contacts.robot, contacts.blockade, contacts.crossings) == (0, 0, 0, 0)


def test_a_robot_waits_while_its_way_is_being_cleared(tmp_path: Path) -> None:
    scenario = two_rooms(tmp_path)
    explorer, clearer = scenario.robots
    near = replace(scenario, robots=(explorer, replace(clearer, pose=(7.5, 3.5, 0.0))))
    near = replace(near, blockades=(replace(scenario.blockades[0], clear_duration_s=1.0),))
    result, dispatcher = run(near)
    assert result.outcome == "completed"
    assert result.commands_failed == 0
    assert not any(report["failed"] for report in dispatcher.reports)
    assert_sound(result)


def test_a_hidden_blockade_is_met_cleared_and_passed(tmp_path: Path) -> None:
    result, dispatcher = run(two_rooms(tmp_path))
    assert result.outcome == "completed"
    assert set(result.visited) == {"near", "far"}
    assert result.sensed["blockade_1"] < result.cleared["blockade_1"] < result.visited["far"]
    assert_sound(result)
    sensed = [r for r in dispatcher.reports if r["blockades"]]
    assert [b["id"] for b in sensed[0]["blockades"]] == ["blockade_1"]


def test_the_fleet_tells_nobody_of_blockades_before_it_senses_them(tmp_path: Path) -> None:
    _, dispatcher = run(two_rooms(tmp_path))
    assert "blockade" not in str(dispatcher.request)


def test_blockades_known_from_the_start_are_in_the_first_report(tmp_path: Path) -> None:
    _, dispatcher = run(replace(two_rooms(tmp_path), blockades_known=True))
    told = [[blockade["id"] for blockade in report["blockades"]] for report in dispatcher.reports]
    assert len(told[0]) == 1
    assert not any(told[1:])


def test_the_same_seed_gives_the_same_mission(tmp_path: Path) -> None:
    first, _ = run(two_rooms(tmp_path, seed=3))
    second, _ = run(two_rooms(tmp_path, seed=3))
    assert first.time_s == second.time_s
    assert all(np.array_equal(first.tracks[r], second.tracks[r]) for r in first.tracks)
    assert first.actions == second.actions


def test_a_way_of_known_length_takes_the_time_that_its_speed_says(tmp_path: Path) -> None:
    scenario = two_rooms(tmp_path, blocked=False)
    scenario = replace(
        scenario,
        robots=(RobotStart("explorer_1", "explorer", (2.0, 3.5, 0.0)),),
        targets=(Target("far", (17.0, 3.5)),),
    )
    result, _ = run(scenario)
    assert result.time_s == pytest.approx(15.0, abs=1.0)
    assert result.driven_m["explorer_1"] == pytest.approx(15.0, abs=0.4)


def test_two_robots_pass_one_another_where_there_is_one_place_to(tmp_path: Path) -> None:
    slim = RobotType("explorer", radius_m=0.25, beams=36)
    scenario = FleetScenario(
        name="corridor",
        map_path=write_floor(tmp_path, CORRIDOR),
        robot_types=(slim,),
        robots=(
            RobotStart("explorer_1", "explorer", (1.5, 1.5, 0.0)),
            RobotStart("explorer_2", "explorer", (22.0, 1.5, 3.1)),
        ),
        # Each one's nearest target is beyond the other robot's start.
        targets=(Target("right", (21.0, 1.5)), Target("left", (2.5, 1.5))),
    )

    class Crossing(Dispatcher):
        def order(self, robot: dict[str, object]) -> None:
            goal = {"explorer_1": "right", "explorer_2": "left"}[str(robot["id"])]
            if goal in self.unvisited:
                self.revision += 1
                self.commands[str(robot["id"])] = {
                    "id": f"r{self.revision}-{robot['id']}",
                    "robot": robot["id"],
                    "kind": "explore",
                    "location": goal,
                }

    simulation = Simulation(scenario, FleetClient(Crossing()))
    for progress in simulation.run():
        assert progress.time_s < 300.0
    assert simulation.result is not None
    assert simulation.result.outcome == "completed"
    assert_sound(simulation.result)


def test_the_rest_of_the_team_goes_on_when_a_robot_dies(tmp_path: Path) -> None:
    scenario = two_rooms(tmp_path, blocked=False)
    scenario = replace(
        scenario,
        robots=(*scenario.robots, RobotStart("explorer_2", "explorer", (4.0, 2.0, 0.0))),
        failures=(Failure("explorer_1", 2.0),),
    )
    result, dispatcher = run(scenario)
    assert result.outcome == "completed"
    states = {r["id"]: r["state"] for r in dispatcher.reports[-1]["robots"]}
    assert states["explorer_1"] == "failed"
    assert_sound(result)


def test_a_stall_delays_and_does_not_end_a_mission(tmp_path: Path) -> None:
    plain, _ = run(two_rooms(tmp_path, blocked=False))
    stalled, _ = run(
        replace(two_rooms(tmp_path, blocked=False), failures=(Failure("explorer_1", 2.0, 20.0),))
    )
    assert stalled.outcome == "completed"
    assert stalled.time_s == pytest.approx(plain.time_s + 20.0, abs=3.0)


def test_a_target_in_a_closed_room_ends_stuck_or_out_of_time(tmp_path: Path) -> None:
    closed = "#########\n#...#...#\n#...#...#\n#...#...#\n#########"
    scenario = FleetScenario(
        name="closed",
        map_path=write_floor(tmp_path, closed),
        robot_types=(EXPLORER,),
        robots=(RobotStart("explorer_1", "explorer", (2.0, 2.0, 0.0)),),
        targets=(Target("beyond", (6.0, 2.0)),),
        time_limit_s=60.0,
    )
    result, _ = run(scenario)
    assert result.outcome == "out of time"
    assert result.visited == {}


def test_robots_that_start_in_one_another_are_refused(tmp_path: Path) -> None:
    scenario = two_rooms(tmp_path)
    robots = (scenario.robots[0], replace(scenario.robots[1], pose=scenario.robots[0].pose))
    with pytest.raises(ScenarioError, match="'clearer_1' cannot stand"):
        Simulation(replace(scenario, robots=robots), FleetClient(Dispatcher()))
