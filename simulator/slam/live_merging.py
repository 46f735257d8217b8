"""A fleet whose robots do not know where they started: maps merged while they drive, then missions.

Each robot runs SLAM on its own scans in a frame of its own and tries from time to time to join the
joint map over the service (`simulator.slam.distributed`). Once it has joined, it can report in the
joint frame; the joint map is the one the coordination service plans on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from simulator.fleet_client import CoordinationService
from simulator.occupancy_grid import OccupancyGrid, packed
from simulator.slam.distributed import MapExchange, join, overlaid
from simulator.slam.experiments.drive import Laser, OdometryNoise, Surveyor
from simulator.slam.front_end import FrontEnd, FrontEndParameters
from simulator.slam.grid_front_end import GridFrontEndParameters
from simulator.slam.pose import Poses, compose, inverse, transform
from simulator.slam.robot_map import map_with_known_poses


@dataclass(frozen=True, slots=True)
class LiveParameters:
    """When robots try to join."""

    first_nodes: int = 60
    """nodes of a robot's graph before it founds the joint map or tries to join it"""
    retry_nodes: int = 40
    laser: Laser = field(default_factory=lambda: Laser(range_m=20.0))
    odometry: OdometryNoise = field(default_factory=OdometryNoise)
    front_end: FrontEndParameters = field(default_factory=FrontEndParameters)
    merging: GridFrontEndParameters = field(default_factory=GridFrontEndParameters)


@dataclass(frozen=True, slots=True)
class Member:
    """A robot at the end of the survey."""

    joined_at_step: int | None
    """step of its drive, None if it never joined"""
    frame: Poses | None
    """(3,): its own frame in the joint one"""
    pose: Poses
    """(3,): where it believes to be, in its own frame"""
    truth: Poses
    """(3,): where it is, in the world; only the simulation knows"""

    def world_in_joint(self) -> Poses:
        """(3,): the world's frame in the joint one, as far as this robot can tell.

        Raises:
            ValueError: the robot has not joined.
        """
        if self.frame is None:
            raise ValueError("a robot that has not joined knows nothing of the joint frame")
        return compose(compose(self.frame, self.pose), inverse(self.truth))


def survey(
    grid: OccupancyGrid,
    tours: Mapping[str, Sequence[tuple[float, float]]],
    exchange: MapExchange,
    name: str,
    *,
    random: np.random.Generator,
    parameters: LiveParameters | None = None,
) -> dict[str, Member]:
    """Drives all robots at the same time and merges their maps on the way.

    Args:
        grid: the building, which robots know only through their lasers.
        tours: robot -> waypoints in the world.
        exchange: the service's maps.
        name: of the joint map.
        random: noise, particles, samples.
        parameters: see there.
    """
    parameters = parameters or LiveParameters()
    surveyor = Surveyor(grid)
    drives = {
        robot: surveyor.drive(surveyor.path(tour), parameters.laser, parameters.odometry, random)
        for robot, tour in tours.items()
    }
    front_ends = {robot: FrontEnd(robot, parameters.front_end) for robot in tours}
    joined: dict[str, tuple[int, Poses]] = {}
    due = dict.fromkeys(tours, parameters.first_nodes)
    for step in range(max(len(drive.scans) for drive in drives.values())):
        for robot, drive in drives.items():
            if step >= len(drive.scans):
                continue
            front_end = front_ends[robot]
            last = step == len(drive.scans) - 1
            front_end.add(drive.scans[step])
            if robot in joined or (len(front_end.scans) < due[robot] and not last):
                continue
            due[robot] = len(front_end.scans) + parameters.retry_nodes
            found = join(exchange, name, front_end.finish(), random, parameters.merging)
            if found is not None:
                joined[robot] = (step, found.frame)
    members = {}
    for robot, drive in drives.items():
        step_and_frame = joined.get(robot)
        pose = front_ends[robot].pose(drive.scans[-1].odometry)
        frame = step_and_frame[1] if step_and_frame else None
        at = step_and_frame[0] if step_and_frame else None
        members[robot] = Member(at, frame, pose, drive.truth[-1])
        if frame is not None:
            _publish_rest(exchange, name, front_ends[robot], frame, parameters.merging)
    return members


def _publish_rest(
    exchange: MapExchange,
    name: str,
    front_end: FrontEnd,
    frame: Poses,
    parameters: GridFrontEndParameters,
) -> None:
    """Adds what a robot saw after it had joined."""
    whole = front_end.robot_map
    moved = whole.with_graph(whole.graph.moved(frame))
    own = map_with_known_poses([moved], parameters.resolution_m, parameters.reach_m)
    for _ in range(5):
        fetched = exchange.fetch(name)
        if fetched is None or exchange.publish(name, overlaid(fetched[0], own), fetched[1]):
            return


class JointFrameService:
    """A coordination service as a fleet in the joint frame talks to it.

    The simulation moves robots in the world; robots report, and take orders, in the joint frame,
    each as well as its own SLAM knows it. Neither side learns of the other's frame.
    """

    def __init__(
        self,
        service: CoordinationService,
        joint_map: OccupancyGrid,
        members: Mapping[str, Member],
    ) -> None:
        self._service = service
        self._map = joint_map
        self._frames = {robot: member.world_in_joint() for robot, member in members.items()}
        # Targets and blockades are told by whoever joined first.
        self._common = next(iter(self._frames.values()))

    @property
    def retries(self) -> int:
        """Requests that had to be sent again."""
        return self._service.retries

    def create_mission(self, request: Mapping[str, Any]) -> str:
        """Creates the mission on the joint map, with everything in the joint frame."""
        rows, columns = self._map.cells.shape
        body = {
            **request,
            "map": {
                "resolution_m": self._map.resolution_m,
                "origin_m": list(self._map.origin_m),
                "width": columns,
                "height": rows,
                "encoding": "zlib+base64",
                "cells": packed(self._map.cells),
            },
            "robots": [self._robot(robot) for robot in request["robots"]],
            "targets": [
                {**target, "position_m": self._point(self._common, target["position_m"])}
                for target in request["targets"]
            ],
        }
        return self._service.create_mission(body)

    def report(self, mission: str, body: Mapping[str, Any]) -> dict[str, Any]:
        """Reports in the joint frame; paths come back in the world's."""
        sent = {
            **body,
            "robots": [self._robot(robot) for robot in body["robots"]],
            "blockades": [
                {
                    **blockade,
                    "segment_m": [self._point(self._common, end) for end in blockade["segment_m"]],
                }
                for blockade in body["blockades"]
            ],
        }
        answer = self._service.report(mission, sent)
        commands = []
        for command in answer["commands"]:
            back = inverse(self._frames[command["robot"]])
            path = [self._point(back, point) for point in command.get("path_m") or ()]
            commands.append({**command, "path_m": path})
        return {**answer, "commands": commands}

    def _robot(self, robot: Mapping[str, Any]) -> dict[str, Any]:
        pose = compose(self._frames[robot["id"]], np.array(robot["pose"], dtype=np.float64))
        return {**robot, "pose": [round(float(value), 4) for value in pose]}

    def _point(self, frame: Poses, point: Sequence[float]) -> list[float]:
        moved = transform(frame, np.array([point], dtype=np.float64))[0]
        return [round(float(value), 4) for value in moved]
