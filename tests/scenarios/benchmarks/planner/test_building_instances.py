"""Random problems on drawn buildings: the size asked for, solvable, the same for one seed."""

import pytest

import planner
from scenarios.benchmarks.planner import building_instances
from scenarios.benchmarks.planner.team_instances import DISASTER


def test_a_building_has_what_was_asked_for_and_a_plan() -> None:
    text = building_instances.disaster("random_building", (2, 1), 6, 5, seed=2)
    problem = planner.read_problem(planner.read_domain(DISASTER), text)
    kinds = [types[0] for types in problem.objects.values()]
    counts = {kind: kinds.count(kind) for kind in ("explorer", "clearer", "spot", "blockade")}
    assert counts == {"explorer": 2, "clearer": 1, "spot": 9, "blockade": 5}
    plan = planner.solve(problem.domain, problem, first_plan_only=True).plan
    assert plan is not None
    # Some of the targets are behind blockades.
    assert "clear" in {step.action for step in plan.steps}
    assert text == building_instances.disaster("random_building", (2, 1), 6, 5, seed=2)
    assert text != building_instances.disaster("random_building", (2, 1), 6, 5, seed=3)


def test_a_building_without_room_says_so() -> None:
    with pytest.raises(ValueError, match="no office has room for 900 targets and 5 blockades"):
        building_instances.disaster("office", (2, 1), 900, 5, seed=1)
