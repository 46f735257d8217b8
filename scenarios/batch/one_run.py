"""One run of a suite: from its specification to a row of results."""

from __future__ import annotations

import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from planner.memory import peak_mb
from scenarios.batch.suite import RunSpec
from scenarios.composition import Composition, compose
from scenarios.maps.floor_plan import FREE
from scenarios.mission import RunOptions, run
from scenarios.mission_record import MissionRecord
from scenarios.scenario_file import read_scenario

Row = dict[str, Any]


def composed(spec: RunSpec, planning: dict[str, Any] | None, folder: Path) -> Composition:
    """The scenario of a run with its team, map and share of blockades."""
    scenario = read_scenario(Path(spec.scenario))
    update: dict[str, Any] = {"team": dict(spec.team), "robots": ()}
    update["blockade_share"] = spec.blockade_share
    update["blockades_known"] = spec.blockades_known
    if spec.generator is not None:
        section = {"generator": spec.generator, "file": None, "image": None, "annotations": None}
        update["map"] = scenario.map.model_copy(update=section)
        update["targets"], update["blockades"] = (), ()
    if spec.map_seed is not None:
        update["map"] = update.get("map", scenario.map).model_copy(update={"seed": spec.map_seed})
    if planning is not None:
        update["planning"] = scenario.planning.model_copy(update=planning)
    return compose(
        scenario.model_copy(update=update),
        seed=spec.seed,
        folder=folder,
        strategy=spec.coordination,
    )


def row_of(record: MissionRecord) -> Row:
    """What a suite keeps of a mission."""
    return {
        "status": record.status,
        "reason": record.status_reason if not record.completed else "",
        "duration_s": round(record.duration_s, 3),
        "targets_left": record.targets_left,
        "sealed_fraction": round(record.sealed_fraction, 3),
        "blockades": len(record.blockades),
        "blockades_seen": record.blockades_seen,
        "blockades_cleared": record.blockades_cleared,
        "replans": record.replans,
        "plans": len(record.plans),
        "plans_accepted": record.plans_accepted,
        "wall_collisions": record.wall_collisions,
        "robot_collisions": record.robot_collisions,
        "blockade_crossings": record.blockade_crossings,
        "distance_m": round(record.distance_m, 2),
        "wall_s": round(record.wall_s, 3),
        "planning_s": round(record.planning_s, 3),
    }


def row_of_run(spec: RunSpec, planning: dict[str, Any] | None) -> Row:
    """Runs the mission of a specification in this process.

    Args:
        planning: settings of the suite that take the place of the scenario's.
    """
    begin_s = time.process_time()
    with TemporaryDirectory(prefix="marsupial-") as scratch:
        composition = composed(spec, planning, Path(scratch))
        options = RunOptions(seed=spec.seed, strategy=spec.coordination, headless=True)
        record = run(composition, options, lambda _: None)
    row = row_of(record)
    if record.known_share is not None:
        row["known_share"] = round(record.known_share, 4)
        free_m2 = float((composition.cells == FREE).sum()) * composition.resolution_m**2
        row["area_m2"] = round(record.known_share * free_m2, 1)
    row["cpu_s"] = round(time.process_time() - begin_s, 3)
    row["peak_mb"] = peak_mb()
    return row
