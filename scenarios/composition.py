"""Composes what a simulation is given from a scenario file and a seed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.building_image import sample
from scenarios.maps.files import write_map
from scenarios.maps.free_space import closed, component_at, components
from scenarios.maps.starts import draw_starts
from scenarios.scenario_file import ScenarioFile
from semantic_attachments.map_server import read_map
from simulator.fleet_scenario import (
    Failure,
    FleetScenario,
    HiddenBlockade,
    Noise,
    RobotStart,
    RobotType,
    Target,
)


@dataclass(frozen=True)
class Composition:
    """A fleet scenario and what a report wants to know about it."""

    fleet: FleetScenario
    cells: NDArray[np.int8]
    """`(height, width)`, row 0 at the bottom"""
    resolution_m: float
    origin_m: tuple[float, float]
    sealed_fraction: float
    """share of the targets that no robot reaches from its start before something is cleared"""


def compose(
    scenario: ScenarioFile, *, seed: int, folder: Path, strategy: str | None = None
) -> Composition:
    """Draws the start poses by `seed`; a map that is an image is sampled into `folder`.

    Raises:
        ValueError: the scenario contradicts itself or its map.
    """
    map_path = _map_path(scenario, folder)
    grid = read_map(map_path)
    cells, resolution_m, origin_m = grid.cells, grid.resolution_m, grid.origin_m
    robots = _robots(scenario, seed, cells, resolution_m, origin_m)
    fleet = FleetScenario(
        name=f"{scenario.name}, seed {seed}",
        map_path=map_path,
        robot_types=tuple(
            RobotType(name=name, **section.model_dump())
            for name, section in scenario.robot_types.items()
        ),
        robots=robots,
        targets=tuple(Target(target.id, target.position_m) for target in scenario.targets),
        blockades=tuple(
            HiddenBlockade(blockade.id, blockade.segment_m, blockade.clear_duration_s)
            for blockade in scenario.blockades
        ),
        domain=scenario.domain,
        strategy=strategy or scenario.strategy,
        seed=seed,
        time_limit_s=scenario.time_limit_s,
        report_period_s=scenario.report_period_s,
        noise=Noise(**scenario.noise.model_dump()),
        communication_range_m=scenario.communication_range_m,
        failures=tuple(Failure(**failure.model_dump()) for failure in scenario.failures),
    )
    return Composition(
        fleet, cells, resolution_m, origin_m, _sealed(fleet, cells, resolution_m, origin_m)
    )


def map_cells(scenario: ScenarioFile, folder: Path) -> NDArray[np.int8]:
    """The occupancy grid `(height, width)` of a scenario's map."""
    return read_map(_map_path(scenario, folder)).cells


def _map_path(scenario: ScenarioFile, folder: Path) -> Path:
    section = scenario.map
    if section.file is not None:
        return section.file
    if section.image is None or section.size_m is None:
        raise ValueError(f"scenario {scenario.name!r} has no map")
    cells = sample(section.image, section.size_m, section.resolution_m, section.inside_m)
    return write_map(folder, section.image.stem, cells, section.resolution_m)


def _robots(
    scenario: ScenarioFile,
    seed: int,
    cells: NDArray[np.int8],
    resolution_m: float,
    origin_m: tuple[float, float],
) -> tuple[RobotStart, ...]:
    """The robots of the file, then those of the team with drawn start poses."""
    placed = [RobotStart(r.id, r.type, r.pose, r.carrier) for r in scenario.robots]
    team = [
        (f"{kind}_{number}", kind)
        for kind, count in scenario.team.items()
        for number in range(1, count + 1)
    ]
    if not team:
        return tuple(placed)
    widest = max(scenario.robot_types[kind].radius_m for _, kind in team)
    poses = draw_starts(
        cells,
        resolution_m,
        origin_m,
        robots=len(team),
        clearance_m=widest + resolution_m,
        seed=f"starts {seed}",
        blockades_m=[blockade.segment_m for blockade in scenario.blockades],
    )
    drawn = [RobotStart(name, kind, pose) for (name, kind), pose in zip(team, poses, strict=True)]
    return (*placed, *drawn)


def _sealed(
    fleet: FleetScenario,
    cells: NDArray[np.int8],
    resolution_m: float,
    origin_m: tuple[float, float],
) -> float:
    shut = closed(
        cells,
        resolution_m,
        [
            ((a[0] - origin_m[0], a[1] - origin_m[1]), (b[0] - origin_m[0], b[1] - origin_m[1]))
            for a, b in (blockade.segment_m for blockade in fleet.blockades)
        ],
    )
    radius_m = min(robot_type.radius_m for robot_type in fleet.robot_types)
    labels = components(shut, resolution_m, radius_m)

    def component(x: float, y: float) -> int:
        return component_at(labels, resolution_m, (x - origin_m[0], y - origin_m[1]))

    open_to_someone = {component(*robot.pose[:2]) for robot in fleet.robots} - {0}
    sealed = sum(component(*target.position_m) not in open_to_someone for target in fleet.targets)
    return sealed / max(1, len(fleet.targets))
