"""Random problems of two families: the size asked for, solvable, the same for one seed."""

import planner
from scenarios.benchmarks.planner import team_instances


def test_a_floor_has_what_was_asked_for_and_a_plan() -> None:
    text = team_instances.disaster(2, 2, 5, 6, seed=3)
    problem = planner.read_problem(planner.read_domain(team_instances.DISASTER), text)
    kinds = [types[0] for types in problem.objects.values()]
    counts = {kind: kinds.count(kind) for kind in ("explorer", "clearer", "spot", "blockade")}
    assert counts == {"explorer": 2, "clearer": 2, "spot": 9, "blockade": 6}
    assert planner.solve(problem.domain, problem, first_plan_only=True).plan is not None
    assert text == team_instances.disaster(2, 2, 5, 6, seed=3)
    assert text != team_instances.disaster(2, 2, 5, 6, seed=4)


def test_rovers_are_carried_to_their_targets() -> None:
    text = team_instances.marsupial(2, 4, 6, 3, seed=1)
    problem = planner.read_problem(planner.read_domain(team_instances.MARSUPIAL), text)
    plan = planner.solve(problem.domain, problem, first_plan_only=True).plan
    assert plan is not None
    assert {"undock", "explore"} <= {step.action for step in plan.steps}
    assert text == team_instances.marsupial(2, 4, 6, 3, seed=1)


def test_ways_go_through_open_doors() -> None:
    rooms = [frozenset({(0, 0)}), frozenset({(1, 0)}), frozenset({(0, 0), (1, 0)})]
    start = team_instances.Node("a", 0.0, 0.0, rooms[0])
    end = team_instances.Node("b", 6.0, 0.0, rooms[1])
    door = team_instances.Node("", 3.0, 4.0, rooms[2])
    assert team_instances._ways_m(start, [start, end], [door]) == [(end, 10.0)]
    assert team_instances._ways_m(start, [start, end], []) == []
