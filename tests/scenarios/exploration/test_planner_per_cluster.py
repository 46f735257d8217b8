"""Every cluster of robots has a planner of its own, which goes on with what its members knew."""

from collections.abc import Mapping

import numpy as np
import pytest

from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import generated
from scenarios.exploration.coordination import StrategyAtWork
from scenarios.exploration.one_run import RunParameters, explore, row_of
from scenarios.exploration.planner_per_cluster import PlannerPerCluster
from semantic_attachments.world import RobotModel
from service.coordination.exploration.cost_based import NearestFrontier
from service.coordination.exploration.strategy import Exploring
from simulator.kinematic_exploration import Decide, Errand, KinematicParameters, TeamView
from simulator.occupancy_grid import OccupancyGrid

SHORT = RunParameters(KinematicParameters(communication_range_m=10.0))


def planners() -> PlannerPerCluster:
    model = RobotModel(type="explorer", radius_m=0.25, speed_m_s=0.5, sensor_range_m=5.0)
    strategy = Exploring(NearestFrontier(), "nearest")
    return PlannerPerCluster(lambda: StrategyAtWork(strategy, model))


def view_of(*members: str) -> TeamView:
    """Robots in a hall of which the left part is known."""
    cells = np.full((20, 60), -1, dtype=np.int8)
    cells[5:15, 2:30] = 0
    places = {name: (2.0 + 0.8 * k, 2.0) for k, name in enumerate(sorted(members))}
    return TeamView(0.0, OccupancyGrid(cells, 0.2, (0.0, 0.0)), places, frozenset(members))


def test_a_cluster_keeps_its_planner_until_somebody_joins_or_leaves() -> None:
    per_cluster = planners()
    for members in (("a", "b"), ("c",), ("a", "b"), ("c",)):
        assert set(per_cluster(view_of(*members))) == set(members)
    assert len(per_cluster.planners) == 2
    assert [len(planner.decision_cpu_s) for planner in per_cluster.planners] == [2, 2]
    per_cluster(view_of("a", "b", "c"))
    assert len(per_cluster.planners) == 3
    per_cluster(view_of("a", "b"))
    assert len(per_cluster.planners) == 4
    assert len(per_cluster.decision_cpu_s) == 6


def test_who_parts_company_goes_on_with_the_targets_of_before() -> None:
    per_cluster = planners()
    per_cluster(view_of("a", "b"))
    before = dict(per_cluster.planners[0].known_targets_m)
    assert before
    per_cluster(view_of("a"))
    assert dict(per_cluster.planners[1].known_targets_m) == before


@pytest.mark.parametrize("arm", ["nearest", "segments"])
def test_robots_out_of_touch_explore_everything_all_the_same(arm: str) -> None:
    building = generated("small_rooms", 3)
    row = row_of(building, 4, 2, ARMS[arm](building), strategy_name=arm, parameters=SHORT)
    assert row["status"] == "completed"
    assert row["known_share"] > 0.99
    assert row["clusters"] > 1


def test_a_planner_is_asked_about_its_own_cluster_only() -> None:
    building = generated("small_rooms", 3)
    asked: list[tuple[frozenset[str], frozenset[str]]] = []

    def watched(at_work: PlannerPerCluster) -> Decide:
        def decide(view: TeamView) -> Mapping[str, Errand]:
            errands = at_work(view)
            asked.append((view.members, frozenset(errands)))
            return errands

        return decide

    explore(building, 4, 2, ARMS["nearest"](building), SHORT, watched=watched)
    assert all(sent <= members for members, sent in asked)
    assert {len(members) for members, _ in asked} > {4}
