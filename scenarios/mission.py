"""Runs a scenario: service, simulated fleet, record, table, report."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import numpy as np

from scenarios.composition import Composition, compose
from scenarios.exit_codes import NO_SOLUTION, TIME_LIMIT, CommandError
from scenarios.in_process_service import ADDRESS, service_in_process
from scenarios.mission_record import (
    Activity,
    BlockadeRecord,
    DecisionRecord,
    MissionRecord,
    RobotRecord,
    TargetRecord,
)
from scenarios.plan_listener import PlanListener
from scenarios.progress import Listener, shown
from scenarios.report.movie import MovieError, require_writable, write_movie
from scenarios.report.page import write_report
from scenarios.report.table import print_table
from scenarios.scenario_file import ScenarioFileError, read_scenario
from scenarios.service_link import ServiceLink
from service.client import ServiceError
from service.settings import Settings
from simulator.fleet_client import FleetClient, FleetClientError
from simulator.fleet_scenario import FleetScenario
from simulator.simulation import Simulation, SimulationResult


@dataclass(frozen=True)
class RunOptions:
    """What a caller of `run` may choose."""

    seed: int = 1
    strategy: str | None = None
    """the scenario's if None"""
    service: str | None = None
    """address of a running service; None starts one in this process"""
    key: str | None = None
    """API key for it"""
    headless: bool = False
    json_file: Path | None = None
    report: Path | None = None
    """None for a name in `out`; a headless run writes a report only if it is named"""
    movie: Path | None = None
    """a film of the mission, .gif or .mp4"""
    out: Path = Path("out")


def run_and_report(scenario: Path, options: RunOptions) -> None:
    """Runs a scenario for the command line.

    Raises:
        CommandError: the scenario cannot be run, or its mission did not complete.
    """
    if options.movie is not None:
        try:
            require_writable(options.movie)
        except MovieError as error:
            raise CommandError(str(error)) from None
    with TemporaryDirectory(prefix="marsupial-") as scratch:
        composition = composed(scenario, options, Path(scratch))
        with shown(headless=options.headless) as listener:
            record = run(composition, options, listener)
        if options.json_file is not None:
            options.json_file.parent.mkdir(parents=True, exist_ok=True)
            options.json_file.write_text(json.dumps(record.to_json(), indent=1), encoding="utf-8")
        if not options.headless:
            print_table(record)
        if not options.headless or options.report is not None:
            name = f"{scenario.stem}-{record.strategy}-seed{record.seed}.html"
            path = write_report(options.report or options.out / name, record, composition)
            print(f"report: {path.resolve()}")
        if options.movie is not None:
            write_movie(options.movie, record, composition)
            print(f"movie: {options.movie.resolve()}")
    if not record.completed:
        raise CommandError(
            f"the mission ended {record.status} with {record.targets_left} targets left"
            + (f": {record.status_reason}" if record.status_reason else ""),
            TIME_LIMIT if record.status == "out of time" else NO_SOLUTION,
        )


def composed(scenario: Path, options: RunOptions, folder: Path) -> Composition:
    """Reads and composes a scenario.

    Raises:
        CommandError: it cannot be read or contradicts itself; the message says where.
    """
    try:
        return compose(
            read_scenario(scenario), seed=options.seed, folder=folder, strategy=options.strategy
        )
    except ScenarioFileError as error:
        raise CommandError(str(error)) from None
    except ValueError as error:
        raise CommandError(f"{scenario}: {error}") from None


def run(composition: Composition, options: RunOptions, listener: Listener) -> MissionRecord:
    """Runs a composed scenario and returns what happened.

    Raises:
        CommandError: the service refuses the mission or is out of reach.
    """
    begin_s = time.perf_counter()
    with ExitStack() as stack:
        plans, http = stack.enter_context(_connected(options))
        link = ServiceLink(http, options.key)
        simulation = Simulation(composition.fleet, FleetClient(link))
        try:
            for progress in simulation.run():
                listener(progress)
            mission = link.client.mission(simulation.client.mission).model_dump(mode="json")
        except (FleetClientError, ServiceError) as error:
            raise CommandError(str(error)) from None
    if simulation.result is None:
        raise RuntimeError("the simulation ended without a result")
    wall_s = time.perf_counter() - begin_s
    return record_of(composition, simulation.result, mission, plans, wall_s)


@contextmanager
def _connected(options: RunOptions) -> Iterator[tuple[PlanListener, httpx.Client]]:
    """A client of the service at an address, or of one inside this process."""
    with ExitStack() as stack:
        inner: httpx.BaseTransport
        if options.service is None:
            # The fleet's clock stands still while the service thinks: nothing to wait for, and
            # nobody outlives this process who could read the log.
            settings = Settings(database_url="sqlite://", debounce_s=0.0, executor="threads")
            inner = stack.enter_context(service_in_process(settings))
        else:
            inner = httpx.HTTPTransport()
        plans = PlanListener(inner)
        address = options.service or ADDRESS
        yield plans, stack.enter_context(httpx.Client(transport=plans, base_url=address))


def record_of(
    composition: Composition,
    result: SimulationResult,
    mission: dict[str, Any],
    plans: PlanListener,
    wall_s: float,
) -> MissionRecord:
    """Puts the ground truth of the simulation and the service's account together."""
    fleet = composition.fleet
    visits = {target["id"]: target for target in mission["targets"]}
    known = {blockade["id"]: blockade for blockade in mission["blockades"]}
    height, width = composition.cells.shape
    return MissionRecord(
        scenario=fleet.name,
        strategy=fleet.strategy,
        domain=fleet.domain,
        seed=fleet.seed,
        version=version("marsupial"),
        status=result.outcome,
        known_share=result.known_share if fleet.explores else None,
        pose_error_m=_pose_error_m(result),
        status_reason=str(mission["status_reason"] or ""),
        duration_s=result.time_s,
        wall_s=wall_s,
        planning_s=result.planning_wait_s,
        map_size_m=(width * composition.resolution_m, height * composition.resolution_m),
        sealed_fraction=composition.sealed_fraction,
        wall_collisions=result.contacts.wall,
        robot_collisions=result.contacts.robot,
        blockade_crossings=result.contacts.crossings,
        replans=result.replans,
        robots=tuple(
            RobotRecord(
                start.id,
                start.type,
                tuple((float(t), float(x), float(y)) for t, x, y, _ in result.tracks[start.id]),
                tuple(
                    Activity(action.kind, action.location, action.start_s, action.end_s)
                    for action in result.actions
                    if action.robot == start.id and action.end_s > action.start_s
                ),
                result.driven_m[start.id],
            )
            for start in fleet.robots
        ),
        targets=tuple(
            TargetRecord(
                target.id,
                target.position_m,
                visits[target.id]["visited_by"],
                result.visited.get(target.id),
            )
            for target in fleet.targets
        )
        + _frontiers(fleet, result, visits),
        blockades=tuple(
            BlockadeRecord(
                blockade.id,
                blockade.segment_m,
                blockade.clear_duration_s,
                result.sensed.get(blockade.id),
                known.get(blockade.id, {}).get("cleared_by"),
                result.cleared.get(blockade.id),
            )
            for blockade in fleet.blockades
        ),
        decisions=tuple(
            DecisionRecord(
                float(decision["time_s"]),
                int(decision["revision"]),
                str(decision["kind"]),
                str(decision["reason"]),
            )
            for decision in mission["decisions"]
        ),
        plans=tuple(plans.plans),
    )


def _pose_error_m(result: SimulationResult) -> tuple[float, float] | None:
    if not result.pose_errors:
        return None
    off_m = np.concatenate([errors[:, 0] for errors in result.pose_errors.values()])
    return (float(off_m.mean()), float(off_m.max()))


def _frontiers(
    fleet: FleetScenario, result: SimulationResult, visits: dict[str, Any]
) -> tuple[TargetRecord, ...]:
    """The exploration targets that robots have been to."""
    given = {target.id for target in fleet.targets}
    return tuple(
        TargetRecord(
            name,
            (float(status["position_m"][0]), float(status["position_m"][1])),
            status["visited_by"],
            result.visited.get(name),
        )
        for name, status in visits.items()
        if name not in given and status["visited_by"] is not None
    )
