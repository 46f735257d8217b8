"""A mission from its first report to its end: world, senses, drives and the service's commands."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator._core import Floor
from simulator.clock import Clock
from simulator.contact import Contact
from simulator.driving import Driving
from simulator.execution import ExecutedAction, Execution
from simulator.fleet_client import FleetClient, MissionState
from simulator.fleet_scenario import FleetScenario, Pose
from simulator.homing import Homing
from simulator.knowledge import Knowledge
from simulator.mapping.sensed_map import SensedMap
from simulator.mission_request import mission_request
from simulator.navigation import Navigation
from simulator.noticing import notice
from simulator.occupancy_grid import read_map_server
from simulator.pose_tracking import PoseTracking, drifts
from simulator.radio import Radio
from simulator.reporting import Reporting
from simulator.right_of_way import RightOfWay
from simulator.robot import Robot
from simulator.sensors import RangeFinder
from simulator.world import Contacts, World

_STUCK_AFTER_S = 600.0
"""nobody has driven or worked for so long, and the service has no order: the team is stuck"""


@dataclass(frozen=True, slots=True)
class Progress:
    """A glance at a running simulation."""

    time_s: float
    status: str
    targets: int
    targets_left: int
    blockades_known: int
    blockades_cleared: int
    replans: int
    poses: dict[str, Pose]


@dataclass(frozen=True, slots=True)
class SimulationResult:
    """What happened, from the ground truth's point of view."""

    outcome: str
    """completed, failed, canceled, stuck, or out of time"""
    time_s: float
    """simulated time of the mission"""
    wall_s: float
    planning_wait_s: float
    """share of `wall_s` spent waiting for the service"""
    tracks: dict[str, NDArray[np.float64]]
    """robot -> (samples, 4): time [s], x [m], y [m], heading [rad]"""
    actions: tuple[ExecutedAction, ...]
    visited: dict[str, float]
    """target -> time of its visit [s]"""
    sensed: dict[str, float]
    """blockade -> time it was first sensed [s]"""
    cleared: dict[str, float]
    """blockade -> time it was gone [s]"""
    driven_m: dict[str, float]
    replans: int
    reports: int
    retries: int
    contacts: Contacts
    """touches and crossings; all zero in a sound run"""
    give_ways: int
    """motions planned to let somebody pass"""
    give_way_failures: int
    commands_failed: int
    pose_errors: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    """robot -> (samples, 2): by how much its belief was off [m], [rad]; empty without drift"""
    known_share: float = 1.0
    """share of the building's free cells that the fleet knows in the end"""


class Simulation:
    """One fleet, one building, one mission; the service is only known through the client."""

    def __init__(self, scenario: FleetScenario, client: FleetClient, step_s: float = 0.05) -> None:
        self.scenario = scenario
        self.client = client
        self.clock = Clock(step_s)
        self.random = np.random.default_rng(scenario.seed)
        self.grid = read_map_server(scenario.map_path)
        self.world = World(self.grid, scenario.blockades)
        self.robots = {
            start.id: Robot(start.id, scenario.type_of(start), *start.pose, carrier=start.carrier)
            for start in scenario.robots
        }
        for robot in self.robots.values():
            if robot.is_aboard:
                robot.activity = "docked"
            else:
                self.world.place(robot.id, robot.kind.radius_m, robot.pose)
        walls = Floor(self.grid.walls(), self.grid.resolution_m, self.grid.origin_m)
        self.range_finder = RangeFinder(walls, scenario.noise.laser_range_m)
        sensed_map = SensedMap(self.grid) if scenario.explores else None
        map_known = self.grid if sensed_map is None else sensed_map.grid()
        self.contact = Contact(
            list(self.robots.values()),
            Knowledge(Navigation(map_known), sensed_map),
            _radio(scenario),
        )
        self.execution = Execution(scenario, self.world, self.contact, self.robots)
        self.right_of_way = RightOfWay(self.contact)
        self.driving = Driving(self.world, self.contact, walls)
        self.tracking = (
            PoseTracking(scenario.noise, scenario.seed) if drifts(scenario.noise) else None
        )
        self.homing = Homing(self.contact, self.execution)
        self.reporting = Reporting(scenario, client, self.contact, self.robots)
        self.mission = MissionState("queued", 0, len(scenario.targets), 0)
        self.result: SimulationResult | None = None
        """set when `run` has ended"""
        self._sensed: dict[str, float] = {}
        self._cleared: dict[str, float] = {}
        self._active_s = 0.0
        self._tracks: dict[str, list[tuple[float, float, float, float]]] = {
            robot: [] for robot in self.robots
        }

    def run(self) -> Iterator[Progress]:
        """Runs the mission, yielding every simulated second; `result` holds the outcome after.

        Raises:
            FleetClientError: the service is out of reach or refuses.
        """
        begin_s = time.perf_counter()
        self.client.create_mission(mission_request(self.scenario, self.grid))
        if self.scenario.blockades_known:
            for blockade in self.world.blockades():
                self.contact.base.sense(blockade, self.clock.time_s)
                self._sensed[blockade.id] = self.clock.time_s
        self._meet()
        self._sense(everyone=True)
        self._report()
        yield self.progress()
        outcome = self._outcome()
        while outcome is None:
            self.step()
            if self.clock.every(1.0):
                yield self.progress()
            outcome = self._outcome()
        self.execution.close(self.clock.time_s)
        self.result = self._summary(outcome, time.perf_counter() - begin_s)
        yield self.progress()

    def step(self) -> None:
        """One step of simulated time."""
        clock, robots = self.clock, list(self.robots.values())
        self._break_down()
        if clock.every(0.5):
            self._meet()
        self._sense()
        self.execution.update(clock.time_s)
        if clock.every(0.5):
            self.homing.update(robots, clock.time_s)
            for members in self.contact.groups.members:
                self.right_of_way.update([self.robots[name] for name in members], clock.time_s)
        if clock.every(1.0):
            self._untangle()
        self.driving.drive(robots, clock.time_s, clock.step_s)
        self.world.step(clock.step_s)
        clock.advance()
        self._read_poses()
        self._note_cleared()
        if clock.every(0.5):
            self._track()
        if self.reporting.is_due(clock.time_s):
            self._report()

    def progress(self) -> Progress:
        """How the mission stands."""
        return Progress(
            time_s=self.clock.time_s,
            status=self.mission.status,
            targets=max(len(self.scenario.targets), self.mission.targets_left),
            targets_left=self.mission.targets_left,
            blockades_known=len(self._sensed),
            blockades_cleared=len(self._cleared),
            replans=self.mission.replans,
            poses={robot.id: robot.truth for robot in self.robots.values()},
        )

    # --- parts of a step ---

    def _break_down(self) -> None:
        """Failures and stalls by script."""
        now_s = self.clock.time_s
        for failure in self.scenario.failures:
            if not now_s <= failure.time_s < now_s + self.clock.step_s:
                continue
            robot = self.robots[failure.robot]
            if failure.duration_s is None:
                self.execution.kill(robot, now_s)
                if robot.id in self.contact.linked:
                    self.reporting.reported_s = -math.inf
            else:
                robot.halted_until_s = now_s + failure.duration_s

    def _meet(self) -> None:
        """Robots part and meet; those that meet know, and have orders, together."""
        linked = self.contact.linked
        for members in self.contact.update(list(self.robots.values())):
            group = [self.robots[name] for name in members]
            self.execution.reconsider(group, self.clock.time_s)
            self.execution.look_again(group[0], self.clock.time_s)
            self.execution.assign(members, self.clock.time_s)
        if self.contact.linked - linked:
            self.reporting.reported_s = -math.inf
        if self.clock.every(self.scenario.report_period_s):
            for known in self.contact.out_of_touch():
                known.study_map()

    def _sense(self, everyone: bool = False) -> None:
        """Laser sweeps, spread over the steps of the scan period."""
        present = [robot for robot in self.robots.values() if not robot.is_aboard]
        news: dict[int, Knowledge] = {}
        for offset, robot in enumerate(present):
            if robot.has_failed:
                continue
            if not (everyone or self.clock.every(self.scenario.scan_period_s, offset)):
                continue
            known = self.contact[robot.id]
            near = self.world.blockades_near(robot.position, robot.kind.sensor_range_m)
            scan = self.range_finder.scan(robot, present, near, self.clock.time_s, self.random)
            if self.tracking is not None and self.tracking.is_due(robot, self.clock.time_s):
                self.tracking.correct(robot, scan, known.navigation.grid)
            if known.sensed_map is not None:
                mates = [(r.x, r.y, r.kind.radius_m) for r in present if r is not robot]
                known.sensed_map.insert(scan, mates)
            if self.contact.radio is not None and notice(
                robot, known, self.robots.values(), self.world, self.range_finder.floor
            ):
                self.execution.look_again(robot, self.clock.time_s)
            for name in scan.blockades:
                if name not in known.sensed:
                    known.sense(next(b for b in near if b.id == name), self.clock.time_s)
                    self._sensed.setdefault(name, self.clock.time_s)
                    news[id(known)] = known
        for known in news.values():
            group = [robot for robot in self.robots.values() if self.contact[robot.id] is known]
            self.execution.reconsider(group, self.clock.time_s)

    def _untangle(self) -> None:
        """Robots that want to move and cannot look for another way, then insist on it."""
        present = [robot for robot in self.robots.values() if not robot.is_aboard]
        for robot in self.robots.values():
            if robot.stalled_s < 3.0 or robot.is_immovable(self.clock.time_s):
                continue
            if self.driving.leave_wall(robot, present, self.clock.time_s):
                continue
            if robot.goals:
                route = self.contact[robot.id].navigation.route(robot, robot.goals)
                if route is not None:
                    robot.follow(route)
            else:
                robot.timed = []
            if robot.stalled_s > 6.0:
                self.right_of_way.to_front(robot, self.clock.time_s, "")

    def _read_poses(self) -> None:
        for robot in self.robots.values():
            if robot.is_aboard:
                continue
            body = self.world.pose(robot.id)
            before = robot.truth
            robot.driven_m += math.hypot(body[0] - before[0], body[1] - before[1])
            if self.tracking is None:
                robot.x, robot.y, robot.heading_rad = body
            else:
                self.tracking.move(robot, body)
            if robot.activity == "driving" or robot.is_busy:
                self._active_s = self.clock.time_s
        for robot in self.robots.values():
            if robot.carrier is not None:
                carrier = self.robots[robot.carrier]
                robot.x, robot.y, robot.heading_rad = carrier.pose
                if self.tracking is not None:
                    self.tracking.board(robot, carrier)

    def _note_cleared(self) -> None:
        standing = self.world.blockades()
        if len(self._cleared) < len(self.scenario.blockades) - len(standing):
            names = {blockade.id for blockade in standing}
            for name in self._sensed:
                if name not in names and name not in self._cleared:
                    self._cleared[name] = self.clock.time_s

    def _track(self) -> None:
        now_s = self.clock.time_s
        for robot in self.robots.values():
            self._tracks[robot.id].append((now_s, *robot.truth))
            if self.tracking is not None:
                self.tracking.note(robot)

    def _report(self) -> None:
        self.mission = self.reporting.report(self.execution, self.clock.time_s)

    # --- the end ---

    def _outcome(self) -> str | None:
        if self.mission.status in ("completed", "failed", "canceled"):
            return self.mission.status
        if self.clock.time_s >= self.scenario.time_limit_s:
            return "out of time"
        if self.clock.time_s - self._active_s > _STUCK_AFTER_S:
            return "stuck"
        return None

    def _summary(self, outcome: str, wall_s: float) -> SimulationResult:
        self._track()
        return SimulationResult(
            outcome=outcome,
            time_s=self.clock.time_s,
            wall_s=wall_s,
            planning_wait_s=self.reporting.waited_s,
            tracks={robot: np.array(track) for robot, track in self._tracks.items()},
            actions=tuple(self.execution.actions),
            visited=dict(self.execution.visited),
            sensed=dict(self._sensed),
            cleared=dict(self._cleared),
            driven_m={robot.id: robot.driven_m for robot in self.robots.values()},
            replans=self.mission.replans,
            reports=self.reporting.reports,
            retries=self.client.retries,
            contacts=self.world.contacts,
            give_ways=self.right_of_way.plans,
            give_way_failures=self.right_of_way.failures,
            pose_errors=(
                {}
                if self.tracking is None
                else {robot: np.array(error) for robot, error in self.tracking.errors.items()}
            ),
            known_share=self._known_share(),
            commands_failed=sum(action.outcome == "failed" for action in self.execution.actions),
        )

    def _known_share(self) -> float:
        sensed_map = self.contact.everything().sensed_map
        return 1.0 if sensed_map is None else sensed_map.known_share()


def _radio(scenario: FleetScenario) -> Radio | None:
    communication = scenario.communication
    if communication is None:
        return None
    return Radio(communication.range_m, communication.base_m or scenario.robots[0].pose[:2])
