"""A suite's runs on a real Ray of this machine give the same rows as processes do."""

from pathlib import Path

import pytest

import scenarios
from scenarios.batch.execution import execute, rows
from scenarios.batch.ray_runs import on_ray
from scenarios.batch.run_process import run_in_process
from scenarios.batch.suite import MapEntry, Suite
from scenarios.scenario_file import PlanningSection

ray = pytest.importorskip("ray", reason="Ray is not installed")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_the_same_rows_as_in_processes(tmp_path: Path) -> None:
    hospital = Path(scenarios.__file__).parent / "disaster" / "hospital.toml"
    suite = Suite(
        name="small",
        maps=(MapEntry(name="hospital", scenario=hospital),),
        teams=({"explorer": 4, "clearer": 2},),
        strategies=("nearest",),
        seeds=1,
        planning=PlanningSection(node_limit=500, time_limit_s=10.0),
    )
    try:
        list(execute(suite, tmp_path / "ray", jobs=2, perform=on_ray(2)))
    finally:
        ray.shutdown()
    list(execute(suite, tmp_path / "process", jobs=2, perform=run_in_process))
    measured = ("wall_s", "planning_s", "cpu_s", "peak_mb")
    kept = [
        [{k: v for k, v in row.items() if k not in measured} for row in rows(tmp_path / where)]
        for where in ("ray", "process")
    ]
    assert kept[0] == kept[1]
    assert {row["status"] for row in kept[0]} == {"completed"}
