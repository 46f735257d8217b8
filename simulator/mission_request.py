"""What a fleet tells the service when a mission begins: the prior map, without the blockades.

A fleet that explores knows only how large the map will be.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from simulator.fleet_scenario import MARGIN_M, FleetScenario
from simulator.occupancy_grid import OccupancyGrid, packed

COMMANDS_AHEAD = 10
"""that a robot is given for when it is out of contact"""


def mission_request(scenario: FleetScenario, grid: OccupancyGrid) -> dict[str, Any]:
    """The body of `POST /v1/missions`.

    A robot's `radius_m` is its body's and the margin that it keeps: the service then orders no way
    that the robot would refuse to drive.
    """
    rows, columns = grid.cells.shape
    floor_map: dict[str, Any] = {
        "resolution_m": grid.resolution_m,
        "origin_m": list(grid.origin_m),
        "width": columns,
        "height": rows,
        "encoding": "zlib+base64",
        "cells": packed(np.full_like(grid.cells, -1) if scenario.explores else grid.cells),
    }
    if grid.terrain is not None:
        if not scenario.explores:
            floor_map["terrain"] = packed(grid.terrain)
        floor_map["terrain_classes"] = list(grid.terrain_classes)
    robots = []
    for robot in scenario.robots:
        start: dict[str, Any] = {"id": robot.id, "type": robot.type, "pose": list(robot.pose)}
        if robot.carrier is not None:
            start["carrier"] = robot.carrier
        robots.append(start)
    planning = scenario.planning
    exploration: dict[str, Any] = {"exploration": {}} if scenario.explores else {}
    communication = scenario.communication
    silence: dict[str, Any] = (
        {}
        if communication is None
        else {"lease_s": communication.lease_s, "commands_ahead": COMMANDS_AHEAD}
    )
    return {
        **exploration,
        **silence,
        "name": scenario.name,
        "domain": scenario.domain,
        "strategy": scenario.strategy,
        "map": floor_map,
        "robot_types": {
            kind.name: {
                "radius_m": round(kind.radius_m + MARGIN_M, 6),
                "speed_m_s": kind.speed_m_s,
                "sensor_range_m": kind.sensor_range_m,
                "enters": list(kind.enters),
                **({"capacity": kind.capacity} if kind.capacity else {}),
                "dock_duration_s": scenario.dock_duration_s,
                "undock_duration_s": scenario.undock_duration_s,
            }
            for kind in scenario.robot_types
        },
        "robots": robots,
        "targets": [{"id": t.id, "position_m": list(t.position_m)} for t in scenario.targets],
        "planning": {
            "time_limit_s": planning.time_limit_s,
            "node_limit": planning.node_limit,
            "margin": planning.margin,
            "seed": scenario.seed,
        },
    }
