"""Commands carried out: begun, finished, given up, replaced; failures and stalls by script."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from simulator.execution import Execution
from simulator.fleet_client import Command, FleetClient
from simulator.fleet_scenario import Failure, FleetScenario, RobotStart, RobotType, Target
from simulator.knowledge import Knowledge, Order
from simulator.navigation import Navigation
from simulator.occupancy_grid import read_map_server
from simulator.robot import Robot
from simulator.simulation import Simulation, SimulationResult
from simulator.world import World
from tests.simulator.dispatcher import Dispatcher
from tests.simulator.floors import TWO_ROOMS, two_rooms, write_floor


class Room:
    """The robots of a scenario that know everything of it, and nobody who drives them."""

    def __init__(self, scenario: FleetScenario) -> None:
        grid = read_map_server(scenario.map_path)
        self.world = World(grid, scenario.blockades)
        self.knowledge = Knowledge(Navigation(grid))
        self.robots = {
            start.id: Robot(start.id, scenario.type_of(start), *start.pose)
            for start in scenario.robots
        }
        for robot in self.robots.values():
            self.world.place(robot.id, robot.kind.radius_m, robot.pose)
        known = dict.fromkeys(self.robots, self.knowledge)
        self.execution = Execution(scenario, self.world, known, self.robots)

    def order(self, commands: Sequence[Command], time_s: float = 0.0) -> None:
        given = {command.robot: command for command in commands}
        self.knowledge.orders = {name: Order(0, given.get(name)) for name in self.robots}
        self.execution.assign(list(self.robots), time_s)

    def endings(self) -> list[tuple[str, str | None]]:
        return [(ending.command, ending.reason) for ending in self.knowledge.endings]


@pytest.fixture
def room(tmp_path: Path) -> Room:
    return Room(two_rooms(tmp_path))


def explore(identifier: str, target: str) -> Command:
    return Command(identifier, "explorer_1", "explore", target)


def test_a_command_gives_goals_and_a_way(room: Room) -> None:
    room.order([explore("r1", "far")])
    robot = room.robots["explorer_1"]
    assert robot.goals == [(17.0, 2.0)]
    assert robot.activity == "driving"
    assert robot.route[0] == (2.0, 2.0)
    assert robot.route[-1] == (17.0, 2.0)
    assert room.robots["clearer_1"].activity == "idle"


def test_the_services_path_is_followed_as_it_is_where_the_body_fits(room: Room) -> None:
    path = ((2.0, 2.0), (2.0, 5.0), (4.0, 5.0))
    room.order([replace(explore("r1", "near"), path_m=path)])
    assert room.robots["explorer_1"].route == list(path)


def test_the_same_command_goes_on_and_another_one_replaces_it(room: Room) -> None:
    room.order([explore("r1", "far")])
    robot = room.robots["explorer_1"]
    robot.leg = 1
    room.order([explore("r1", "far")], 3.0)
    assert robot.leg == 1
    room.order([explore("r2", "near")], 5.0)
    assert robot.goals == [(4.0, 5.0)]
    assert [(a.location, a.end_s, a.outcome) for a in room.execution.actions] == [
        ("far", 5.0, "replaced")
    ]
    room.order([], 6.0)
    assert robot.activity == "idle"
    assert robot.route == []


def test_arriving_is_said_once(room: Room) -> None:
    room.order([explore("r1", "near")])
    robot = room.robots["explorer_1"]
    room.execution.update(1.0)
    assert room.endings() == []
    robot.x, robot.y = 4.1, 5.1
    room.execution.update(9.0)
    room.execution.update(9.05)
    assert room.endings() == [("r1", None)]
    assert room.execution.visited == {"near": 9.0}


def test_clearing_takes_its_time_and_opens_the_way_for_those_who_wait(room: Room) -> None:
    blockade = room.world.blockades()[0]
    room.knowledge.sense(blockade, 0.0)
    explorer, clearer = room.robots.values()
    clearer.x, clearer.y = 8.8, 3.5
    room.order([explore("r1", "far"), Command("r1-c", "clearer_1", "clear", "blockade_1")])
    assert explorer.waits_since_s == 0.0
    room.execution.update(0.0)
    assert clearer.activity == "clearing"
    assert room.knowledge.began_work
    # What cannot be interrupted goes on, whatever comes.
    room.order([explore("r1", "far"), Command("r2", "clearer_1", "move", "x")], 2.0)
    room.execution.update(4.9)
    assert room.world.blockades() == (blockade,)
    room.execution.update(5.0)
    assert room.world.blockades() == ()
    assert room.endings() == [("r1-c", None)]
    assert explorer.route[-1] == (17.0, 2.0)


def test_a_blockade_nobody_has_sensed_cannot_be_cleared(room: Room) -> None:
    room.order([Command("r1", "clearer_1", "clear", "blockade_1")])
    room.execution.update(1.0)
    assert room.endings() == [("r1", "path blocked: blockade_1 has not been sensed")]


def test_a_robot_without_a_way_waits_a_little_and_gives_up(room: Room) -> None:
    room.knowledge.sense(room.world.blockades()[0], 0.0)
    room.order([explore("r1", "far")])
    room.execution.update(4.0)
    assert room.endings() == []
    room.execution.update(5.5)
    assert room.endings() == [("r1", "path blocked: no way to far for its body")]


def test_a_new_blockade_on_the_way_is_reconsidered(room: Room) -> None:
    room.order([explore("r1", "far")])
    robot = room.robots["explorer_1"]
    room.knowledge.sense(room.world.blockades()[0], 1.0)
    room.execution.reconsider([robot], 1.0)
    assert robot.route == []
    assert robot.waits_since_s == 1.0


def test_the_dead_obey_nobody_and_stand_in_the_way(room: Room) -> None:
    robot = room.robots["explorer_1"]
    room.execution.kill(robot, 1.0)
    room.order([explore("r1", "near")], 2.0)
    assert robot.activity == "failed"
    assert robot.route == []
    assert room.knowledge.navigation.standing == [(2.0, 2.0, robot.kind.radius_m)]
    assert room.knowledge.dead == {"explorer_1": None}


def test_out_of_contact_a_robot_goes_on_with_what_it_was_told_to_do_next(room: Room) -> None:
    after = explore("r1+1", "far")
    room.order([replace(explore("r1", "near"), then=(after,))])
    robot = room.robots["explorer_1"]
    robot.x, robot.y = 4.0, 5.0
    room.execution.update(5.0)
    assert room.execution.follow_up(robot, 5.0)
    assert robot.goals == [(17.0, 2.0)]
    # The service repeats its order, as it has not heard of anything: that is nothing new.
    room.order([replace(explore("r1", "near"), then=(after,))], 6.0)
    assert robot.goals == [(17.0, 2.0)]
    robot.x, robot.y = 17.0, 2.0
    room.execution.update(25.0)
    assert room.endings() == [("r1", None), ("r1+1", None)]
    assert not room.execution.follow_up(robot, 25.0)


# --- whole missions ---

CARRIER = RobotType("carrier", radius_m=0.4, beams=36, capacity=1)
ROVER = RobotType("rover", radius_m=0.25, speed_m_s=0.5, beams=36)


class Ferry(Dispatcher):
    """Has a carrier bring its rover to the other room, and the rover visit a target there."""

    def order(self, robot: dict[str, Any]) -> None:
        aboard = robot["state"] == "docked"
        place = [[14.0, 3.5]]
        orders: dict[str, dict[str, Any] | None] = {
            "carrier_1": {"kind": "move", "location": "meeting", "path_m": place},
            "rover_1": None if aboard else {"kind": "explore", "location": "far"},
        }
        if robot["pose"][0] > 13.0 and aboard:
            meets = {"kind": "undock", "location": "meeting", "path_m": place}
            orders["rover_1"] = {**meets, "partner": "carrier_1"}
        wanted = orders[robot["id"]]
        if wanted is not None and (robot["id"] != "carrier_1" or robot["pose"][0] < 13.0):
            self.revision += 1
            self.commands[robot["id"]] = {
                "id": f"r{self.revision}",
                "robot": robot["id"],
                **wanted,
            }


def run(scenario: FleetScenario, dispatcher: Dispatcher) -> SimulationResult:
    simulation = Simulation(scenario, FleetClient(dispatcher))
    for _ in simulation.run():
        pass
    assert simulation.result is not None
    return simulation.result


def ferry(folder: Path) -> FleetScenario:
    return FleetScenario(
        name="ferry",
        map_path=write_floor(folder, TWO_ROOMS),
        robot_types=(CARRIER, ROVER),
        robots=(
            RobotStart("carrier_1", "carrier", (2.0, 3.5, 0.0)),
            RobotStart("rover_1", "rover", (2.0, 3.5, 0.0), "carrier_1"),
        ),
        targets=(Target("far", (17.0, 2.0)),),
        time_limit_s=300.0,
    )


def test_a_carrier_gives_up_on_a_rover_that_rides_on_another(tmp_path: Path) -> None:
    scenario = ferry(tmp_path)
    starts = [RobotStart(f"carrier_{k}", "carrier", (2.0, 3.5 + k, 0.0)) for k in (0, 1)]
    rover = RobotStart("rover_1", "rover", (3.0, 3.5, 0.0))
    room = Room(replace(scenario, robots=(*starts, rover)))
    room.robots["rover_1"].carrier = "carrier_1"
    room.order([Command("c1", "carrier_0", "dock", "meeting", "rover_1")])
    room.execution.update(1.0)
    assert room.endings() == [("c1", "path blocked: rover_1 rides on carrier_1")]
    assert room.robots["rover_1"].carrier == "carrier_1"


def test_a_docked_rover_moves_with_its_carrier(tmp_path: Path) -> None:
    result = run(ferry(tmp_path), Ferry())
    assert result.outcome == "completed"
    carrier, rover = result.tracks["carrier_1"], result.tracks["rover_1"]
    off = next(a for a in result.actions if a.robot == "rover_1" and a.kind == "undock")
    riding = rover[:, 0] < off.start_s
    assert riding.sum() > 10
    assert np.array_equal(carrier[riding], rover[riding])
    # It is carried, and drives only from where it got off: about 3 m, slower than its carrier.
    assert result.driven_m["carrier_1"] == pytest.approx(12.0, abs=0.5)
    assert 2.0 < result.driven_m["rover_1"] < 6.0
    visited_s = result.visited["far"]
    assert visited_s > off.end_s
    assert result.contacts.robot == result.contacts.wall == 0


def test_a_carrier_that_stalls_delays_its_rover(tmp_path: Path) -> None:
    plain = run(ferry(tmp_path), Ferry())
    stalls = (Failure("carrier_1", 3.0, 15.0),)
    late = run(replace(ferry(tmp_path), failures=stalls), Ferry())
    assert late.outcome == "completed"
    assert late.visited["far"] == pytest.approx(plain.visited["far"] + 15.0, abs=1.5)
    track = late.tracks["rover_1"]
    halted = track[(track[:, 0] > 3.5) & (track[:, 0] < 17.5)]
    assert np.ptp(halted[:, 1]) < 0.01


@pytest.mark.parametrize("time_s", [1.0, 2.5, 4.0])
def test_a_mission_survives_a_robot_that_dies_out_of_the_way(tmp_path: Path, time_s: float) -> None:
    scenario = two_rooms(tmp_path)
    scenario = replace(
        scenario,
        robots=(*scenario.robots, RobotStart("clearer_2", "clearer", (4.0, 2.0, 0.0))),
        failures=(Failure("clearer_1", time_s),),
        time_limit_s=400.0,
    )
    result = run(scenario, Dispatcher())
    assert result.outcome == "completed"
    track = result.tracks["clearer_1"]
    dead = track[track[:, 0] > time_s + 0.5]
    assert np.ptp(dead[:, 1]) == np.ptp(dead[:, 2]) == 0.0
    assert not any(a.robot == "clearer_1" and a.end_s > time_s + 0.1 for a in result.actions)
    assert result.contacts.robot == result.contacts.crossings == 0
