"""Composes what a simulation is given from a scenario file and a seed."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from random import Random

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.building_image import sample
from scenarios.maps.files import write_map, write_plan
from scenarios.maps.floor_plan import UNKNOWN
from scenarios.maps.free_space import closed, component_at, components
from scenarios.maps.generators import GENERATORS
from scenarios.maps.placement import place
from scenarios.maps.starts import draw_starts
from scenarios.scenario_file import BlockadeSection, ScenarioFile, TargetSection
from simulator.fleet_scenario import (
    Communication,
    Failure,
    FleetScenario,
    HiddenBlockade,
    Noise,
    Planning,
    RobotStart,
    RobotType,
    Target,
)
from simulator.occupancy_grid import OccupancyGrid, read_map_server


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
    scenario, map_path = _with_map(scenario, folder)
    scenario = _with_blockade_share(scenario, seed)
    grid = read_map_server(map_path)
    cells, resolution_m, origin_m = grid.cells, grid.resolution_m, grid.origin_m
    robots = _robots(scenario, seed, grid)
    fleet = FleetScenario(
        name=f"{scenario.name}, seed {seed}",
        map_path=map_path,
        robot_types=_robot_types(scenario, robots),
        robots=robots,
        targets=tuple(Target(target.id, target.position_m) for target in scenario.targets),
        blockades=tuple(
            HiddenBlockade(blockade.id, blockade.segment_m, blockade.clear_duration_s)
            for blockade in scenario.blockades
        ),
        blockades_known=scenario.blockades_known,
        explores=scenario.explores,
        domain=scenario.domain,
        strategy=strategy or scenario.strategy,
        planning=Planning(**scenario.planning.model_dump()),
        seed=seed,
        time_limit_s=scenario.time_limit_s,
        report_period_s=scenario.report_period_s,
        scan_period_s=scenario.scan_period_s,
        noise=Noise(**scenario.noise.model_dump()),
        communication=(
            None
            if scenario.communication is None
            else Communication(**scenario.communication.model_dump())
        ),
        failures=tuple(Failure(**failure.model_dump()) for failure in scenario.failures),
    )
    return Composition(
        fleet, cells, resolution_m, origin_m, _sealed(fleet, cells, resolution_m, origin_m)
    )


def map_cells(scenario: ScenarioFile, folder: Path) -> NDArray[np.int8]:
    """The occupancy grid `(height, width)` of a scenario's map."""
    return read_map_server(_with_map(scenario, folder)[1]).cells


def _with_map(scenario: ScenarioFile, folder: Path) -> tuple[ScenarioFile, Path]:
    """The scenario with the targets and blockades of its map, and the map_server file."""
    section = scenario.map
    if section.file is not None:
        return scenario, section.file
    if section.image is not None and section.size_m is not None:
        cells = sample(section.image, section.size_m, section.resolution_m, section.inside_m)
        return scenario, write_map(folder, section.image.stem, cells, section.resolution_m)
    if section.generator not in GENERATORS:
        known = ", ".join(sorted(GENERATORS))
        raise ValueError(f"map.generator: no {section.generator!r}; use one of {known}")
    generator, parameters = GENERATORS[section.generator]
    plan = generator(section.seed)
    name = f"{section.generator}_{section.seed}"
    path = write_plan(folder, name, plan)
    if scenario.explores:
        return scenario, path
    placement = place(plan, section.seed, parameters)
    update = {
        "targets": (
            *(TargetSection(id=t.id, position_m=t.position_m) for t in placement.targets),
            *scenario.targets,
        ),
        "blockades": (
            *(
                BlockadeSection(id=b.id, segment_m=b.segment_m, clear_duration_s=b.clear_duration_s)
                for b in placement.blockades
            ),
            *scenario.blockades,
        ),
    }
    return scenario.model_copy(update=update), path


def _with_blockade_share(scenario: ScenarioFile, seed: int) -> ScenarioFile:
    kept = round(scenario.blockade_share * len(scenario.blockades))
    if kept == len(scenario.blockades):
        return scenario
    order = sorted(Random(f"blockades {seed}").sample(range(len(scenario.blockades)), kept))
    return scenario.model_copy(update={"blockades": tuple(scenario.blockades[k] for k in order)})


def _robot_types(scenario: ScenarioFile, robots: tuple[RobotStart, ...]) -> tuple[RobotType, ...]:
    """The types of the file; carriers hold at least as many rovers as the team gives each."""
    listed = {robot.id for robot in scenario.robots}
    drawn = [robot for robot in robots if robot.id not in listed]
    aboard = Counter(robot.carrier for robot in drawn if robot.carrier is not None)
    most: dict[str, int] = {}
    for robot in robots:
        most[robot.type] = max(most.get(robot.type, 0), aboard[robot.id])
    types = []
    for name, section in scenario.robot_types.items():
        members = section.model_dump(exclude={"carried_by"})
        members["capacity"] = max(section.capacity, most.get(name, 0))
        types.append(RobotType(name=name, **members))
    return tuple(types)


def _robots(scenario: ScenarioFile, seed: int, grid: OccupancyGrid) -> tuple[RobotStart, ...]:
    """The robots of the file, then those of the team: drawn start poses, or aboard a carrier."""
    robots = [RobotStart(r.id, r.type, r.pose, r.carrier) for r in scenario.robots]
    types = scenario.robot_types
    team = [
        (f"{kind}_{number}", kind)
        for kind, count in scenario.team.items()
        for number in range(1, count + 1)
    ]
    driving = [(name, kind) for name, kind in team if types[kind].carried_by is None]
    if driving:
        widest = max(types[kind].radius_m for _, kind in driving)
        enters = set.intersection(*(set(types[kind].enters) for _, kind in driving))
        cells = grid.cells.copy()
        cells[grid.forbidden(tuple(sorted(enters)))] = UNKNOWN
        poses = draw_starts(
            cells,
            grid.resolution_m,
            grid.origin_m,
            robots=len(driving),
            clearance_m=widest + grid.resolution_m,
            seed=f"starts {seed}",
            blockades_m=[blockade.segment_m for blockade in scenario.blockades],
        )
        robots += [
            RobotStart(name, kind, pose) for (name, kind), pose in zip(driving, poses, strict=True)
        ]
    for kind, section in types.items():
        riders = [name for name, of in team if of == kind and section.carried_by is not None]
        carriers = [robot for robot in robots if robot.type == section.carried_by]
        if riders and not carriers:
            raise ValueError(f"team: {kind} needs a {section.carried_by} to ride on; add one")
        robots += [
            RobotStart(name, kind, carrier.pose, carrier.id)
            for name, carrier in zip(riders, cycle(carriers), strict=False)
        ]
    return tuple(robots)


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
