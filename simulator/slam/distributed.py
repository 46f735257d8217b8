"""Robots exchange compressed maps over the service and agree on one frame; no raw scans travel.

Each robot keeps its scans and its graph to itself. What it publishes is its occupancy grid, zlib
compressed, as a map of the coordination service (`PUT /v1/maps/NAME`); what it needs of another
robot is that robot's grid, in which it localizes itself (Algorithm 3). Constraints against the
other's frame then also correct its own graph. The joint map is a map of the service too: robots
add to it one after the other, with `If-Match`, so that none overwrites another's part, and missions
name it in their request.
"""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass, replace

import httpx
import numpy as np

from simulator.occupancy_grid import OccupancyGrid, packed
from simulator.slam.back_end import optimise_with_outliers
from simulator.slam.consensus import InterEdge, ransac_motions
from simulator.slam.grid_front_end import (
    GridFrontEndParameters,
    learned_threshold,
)
from simulator.slam.localization import SensorField, localize, scan_points
from simulator.slam.pose import Poses, between, compose, inverse
from simulator.slam.pose_graph import Edge, PoseGraph
from simulator.slam.robot_map import RobotMap, map_with_known_poses


class MapExchangeError(RuntimeError):
    """The service refuses a map or cannot be reached; the message says what to do."""


@dataclass(slots=True)
class MapExchange:
    """Grids kept by the service, by name."""

    http: httpx.Client
    sent_bytes: int = 0
    received_bytes: int = 0

    def fetch(self, name: str) -> tuple[OccupancyGrid, str] | None:
        """The grid and its version, or None if nobody has published it.

        Raises:
            MapExchangeError: see there.
        """
        response = self._request("GET", name)
        if response.status_code == 404:
            return None
        self._accept(response, name)
        self.received_bytes += len(response.content)
        message = response.json()["map"]
        cells = np.frombuffer(zlib.decompress(base64.b64decode(message["cells"])), dtype=np.int8)
        grid = OccupancyGrid(
            cells.reshape(message["height"], message["width"]).copy(),
            float(message["resolution_m"]),
            (float(message["origin_m"][0]), float(message["origin_m"][1])),
        )
        return grid, response.headers["ETag"].strip('"')

    def publish(self, name: str, grid: OccupancyGrid, replacing: str | None) -> bool:
        """Publishes a grid if the version that it replaces is current (None: if the name is free).

        Returns:
            whether it counts; if not, somebody else was faster.

        Raises:
            MapExchangeError: see there.
        """
        rows, columns = grid.cells.shape
        body = {
            "resolution_m": grid.resolution_m,
            "origin_m": list(grid.origin_m),
            "width": columns,
            "height": rows,
            "encoding": "zlib+base64",
            "cells": packed(grid.cells),
        }
        known = {"If-None-Match": "*"} if replacing is None else {"If-Match": f'"{replacing}"'}
        response = self._request("PUT", name, body, known)
        if response.status_code == 412:
            return False
        self._accept(response, name)
        self.sent_bytes += len(response.request.content)
        return True

    def _request(
        self,
        method: str,
        name: str,
        body: dict[str, object] | None = None,
        headers: dict[str, str] | None = None,
    ) -> httpx.Response:
        try:
            return self.http.request(method, f"/v1/maps/{name}", json=body, headers=headers)
        except httpx.TransportError as error:
            raise MapExchangeError(
                f"the service at {self.http.base_url} cannot be reached ({error}); start it with "
                "`marsupial serve` or check the address"
            ) from None

    def _accept(self, response: httpx.Response, name: str) -> None:
        if not response.is_success:
            raise MapExchangeError(
                f"the service refuses the map {name!r} ({response.status_code}): "
                f"{response.text[:200]}"
            )


@dataclass(frozen=True, slots=True)
class Joined:
    """A robot's part in the joint map."""

    frame: Poses
    """(3,): the robot's own frame in the joint one"""
    robot_map: RobotMap
    """graph and scans in the joint frame, corrected by the constraints against the joint map"""
    constraints: int


def locate_in(
    grid: OccupancyGrid,
    robot_map: RobotMap,
    random: np.random.Generator,
    parameters: GridFrontEndParameters | None = None,
) -> Joined | None:
    """Where a robot's own map lies in a grid that it was given, as Algorithm 3 but without graph.

    Returns:
        None if fewer than the least number of localizations agree.
    """
    parameters = parameters or GridFrontEndParameters()
    sensor_field = SensorField(grid, parameters.localization)
    threshold = learned_threshold(robot_map, parameters)
    posed, keys = robot_map.posed_scans(), sorted(robot_map.scans)
    edges: list[InterEdge] = []
    k = 0
    while k + parameters.sequence <= len(posed):
        sequence = posed[k : k + parameters.sequence]
        found = localize(sensor_field, sequence, random, parameters.localization)
        k += parameters.stride if found is None else parameters.sequence
        if found is None:
            continue
        last = sequence[-1][0]
        values = []
        for own, scan in sequence[len(sequence) // 2 :]:
            points = scan_points(scan, parameters.localization.beams)
            if len(points) >= 5:
                at = compose(found.pose, between(last, own))
                value = sensor_field.mean_log_likelihood(at[None], points)[0]
                values.append(float(np.exp(value)))
        if values and float(np.mean(values)) > threshold:
            floor = np.diag([1e-3, 1e-3, 1e-4])
            information = np.asarray(np.linalg.inv(found.covariance + floor), dtype=np.float64)
            edges.append(InterEdge("", 0, robot_map.robot, keys[k - 1], found.pose, information))
    own = np.array([robot_map.graph.poses[edge.node_b] for edge in edges]).reshape(-1, 3)
    at = np.array([edge.measurement for edge in edges]).reshape(-1, 3)
    motions = compose(at, inverse(own))
    chosen = ransac_motions(motions, own[:, :2], random, parameters.ransac)
    if len(chosen) < parameters.least_constraints:
        return None
    motion = motions[chosen[len(chosen) // 2]]
    corrected, motion = _corrected(robot_map.graph, motion, [edges[i] for i in chosen], parameters)
    return Joined(motion, robot_map.with_graph(corrected), len(chosen))


def _corrected(
    graph: PoseGraph, motion: Poses, edges: list[InterEdge], parameters: GridFrontEndParameters
) -> tuple[PoseGraph, Poses]:
    """The robot's graph in the joint frame, pulled by its constraints against that frame."""
    # The joint frame is node 0, which the back end holds fast; the robot's nodes move up by one.
    joint = graph.moved(motion).renumbered(1, 0)
    joint.poses = {0: np.zeros(3), **joint.poses}
    joint.edges = [
        *joint.edges,
        *(Edge(0, e.node_b + 1, e.measurement, e.information, "inter") for e in edges),
    ]
    found = optimise_with_outliers(joint, parameters.back_end).graph
    poses = {key: found.poses[key + 1] for key in graph.poses}
    first = min(poses)
    frame = compose(poses[first], inverse(graph.poses[first]))
    return replace(graph, poses=poses, landmarks=found.landmarks), frame


def join(
    exchange: MapExchange,
    name: str,
    robot_map: RobotMap,
    random: np.random.Generator,
    parameters: GridFrontEndParameters | None = None,
    *,
    attempts: int = 5,
) -> Joined | None:
    """Adds a robot's map to the joint map: the first robot's frame is the joint one.

    Returns:
        None if the robot cannot be localized in the joint map (yet).

    Raises:
        MapExchangeError: see there.
    """
    parameters = parameters or GridFrontEndParameters()
    for _ in range(attempts):
        fetched = exchange.fetch(name)
        if fetched is None:
            own = map_with_known_poses([robot_map], parameters.resolution_m, parameters.reach_m)
            if exchange.publish(name, own, None):
                return Joined(np.zeros(3), robot_map, 0)
            continue
        grid, version = fetched
        joined = locate_in(grid, robot_map, random, parameters)
        if joined is None:
            return None
        own = map_with_known_poses([joined.robot_map], parameters.resolution_m, parameters.reach_m)
        if exchange.publish(name, overlaid(grid, own), version):
            return joined
    raise MapExchangeError(f"the joint map {name!r} changed {attempts} times while joining it")


def overlaid(first: OccupancyGrid, second: OccupancyGrid) -> OccupancyGrid:
    """Both grids in one, of the same frame and resolution: occupancy adds up in log odds.

    Raises:
        ValueError: resolutions differ.
    """
    resolution_m = first.resolution_m
    if abs(resolution_m - second.resolution_m) > 1e-9:
        raise ValueError("grids of different resolutions cannot be laid over one another")
    offsets = [
        np.rint(np.array(grid.origin_m) / resolution_m).astype(int) for grid in (first, second)
    ]
    low = np.minimum(*offsets)
    sizes = [np.array(grid.cells.shape[::-1]) for grid in (first, second)]
    high = np.maximum(offsets[0] + sizes[0], offsets[1] + sizes[1])
    odds = np.zeros((int(high[1] - low[1]), int(high[0] - low[0])))
    known = np.zeros(odds.shape, dtype=np.bool_)
    for at, grid in zip(offsets, (first, second), strict=False):
        rows = slice(int(at[1] - low[1]), int(at[1] - low[1]) + grid.cells.shape[0])
        columns = slice(int(at[0] - low[0]), int(at[0] - low[0]) + grid.cells.shape[1])
        percent = np.clip(grid.cells.astype(np.float64), 2.0, 98.0) / 100.0
        seen = grid.cells >= 0
        odds[rows, columns] += np.where(seen, np.log(percent / (1.0 - percent)), 0.0)
        known[rows, columns] |= seen
    percent = np.rint(100.0 / (1.0 + np.exp(-odds))).astype(np.int8)
    cells = np.where(known, percent, np.int8(-1)).astype(np.int8)
    origin = low * resolution_m
    return OccupancyGrid(cells, resolution_m, (float(origin[0]), float(origin[1])))
