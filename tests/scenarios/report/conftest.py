"""A small mission in a building of 12 x 6 m."""

from pathlib import Path

import pytest

from scenarios.composition import Composition, compose
from scenarios.maps.files import write_map
from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.rooms import open_between
from scenarios.mission_record import (
    Activity,
    BlockadeRecord,
    DecisionRecord,
    MissionRecord,
    PlannedStep,
    PlanRecord,
    RobotRecord,
    TargetRecord,
)
from scenarios.scenario_file import read_scenario

SCENARIO = """
name = "small & <odd>"
[map]
file = "small.yaml"
[robot_types.explorer]
[robot_types.clearer]
[[robots]]
id = "explorer_1"
type = "explorer"
pose = [1.5, 1.5, 0.0]
[[robots]]
id = "clearer_1"
type = "clearer"
pose = [3.5, 1.5, 0.0]
[[targets]]
id = "target_1"
position_m = [3.0, 4.5]
[[blockades]]
id = "blockade_1"
segment_m = [[2.6, 2.9], [4.0, 2.9]]
clear_duration_s = 16.8
"""


@pytest.fixture
def composition(tmp_path: Path) -> Composition:
    plan = FloorPlan("small", width=60, height=30, resolution_m=0.2)
    hall = plan.add("corridor", Rectangle(2, 2, 58, 14))
    room = plan.add("room", Rectangle(2, 15, 29, 28))
    open_between(plan, hall, room, 7, None)
    write_map(tmp_path, "small", plan.cells(), plan.resolution_m)
    path = tmp_path / "small.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    return compose(read_scenario(path), seed=4, folder=tmp_path)


@pytest.fixture
def record() -> MissionRecord:
    return MissionRecord(
        scenario="small & <odd>, seed 4",
        strategy="planner",
        domain="disaster",
        seed=4,
        version="0.0",
        status="completed",
        status_reason="",
        duration_s=40.0,
        wall_s=1.0,
        planning_s=0.5,
        map_size_m=(12.0, 6.0),
        sealed_fraction=1.0,
        wall_collisions=0,
        robot_collisions=0,
        blockade_crossings=0,
        replans=2,
        robots=(
            RobotRecord(
                "explorer_1",
                "explorer",
                ((0.0, 1.5, 1.5), (22.0, 1.5, 1.5), (26.0, 3.0, 2.5), (30.0, 3.0, 4.5)),
                (Activity("wait", None, 0.0, 22.0), Activity("explore", "target_1", 22.0, 30.0)),
                4.0,
            ),
            RobotRecord(
                "clearer_1",
                "clearer",
                ((0.0, 3.5, 1.5), (1.0, 3.5, 2.4)),
                (
                    Activity("move", "blockade_1", 0.0, 1.0),
                    Activity("clear", "blockade_1", 1.0, 20.0),
                ),
                0.9,
            ),
        ),
        targets=(TargetRecord("target_1", (3.0, 4.5), "explorer_1", 30.0),),
        blockades=(
            BlockadeRecord("blockade_1", ((2.6, 2.9), (4.0, 2.9)), 16.8, 0.0, "clearer_1", 20.0),
        ),
        decisions=(
            DecisionRecord(0.0, 1, "planned", "the mission begins"),
            DecisionRecord(0.5, 2, "planned", "blockade blockade_1 seen: a plan of 3 steps"),
        ),
        plans=(
            PlanRecord(
                1,
                0.0,
                12.0,
                True,
                (PlannedStep("explore", ("explorer-1", "x", "target-1"), 0.0, 4.0),),
            ),
            PlanRecord(2, 0.5, 28.0, True, (PlannedStep("clear", ("clearer-1", "b"), 1.0, 16.8),)),
        ),
    )
