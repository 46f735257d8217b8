"""Plans: text, JSON, equality."""

import json

import pytest

import planner
from planner import Plan, Step
from tests.planner.problems import MATCH_CELLAR


def test_text_reads_back() -> None:
    problem = planner.read_problem(MATCH_CELLAR.domain, MATCH_CELLAR.problem)
    plan = Plan.from_text(MATCH_CELLAR.plan, problem)
    text = plan.to_text()
    assert text.startswith(";;!domain: match-cellar\n;;!problem: cellar-2\n")
    assert text.endswith("; Makespan: 8.000\n")
    again = Plan.from_text(text, problem)
    assert again == plan
    assert hash(again) == hash(plan)


def test_numbers_are_exact() -> None:
    third = Plan((Step(1 / 3, "light_match", ("m1",), 50 / 3),), metric=1e-7, evaluated=12)
    text = third.to_text()
    assert "0.3333333333333333: (light_match m1) [16.666666666666668]" in text
    assert "; States evaluated: 12\n" in text
    assert "; Metric: 0.0000001\n" in text


def test_a_plan_is_a_sequence_of_steps() -> None:
    steps = (Step(0.0, "a", (), None), Step(1.0, "b", ("x", "y"), 2.5))
    plan = Plan(steps)
    assert (len(plan), plan[1], plan[:1], list(plan)) == (2, steps[1], steps[:1], list(steps))
    assert (plan.makespan, Plan(()).makespan) == (3.5, 0.0)
    assert str(steps[1]) == "(b x y)"
    assert plan != Plan(steps[:1])
    assert plan != "plan"


def test_json_has_the_fields_of_the_command_line() -> None:
    plan = Plan((Step(0.0, "a", ("x",), None),), cpu_s=0.5, wall_s=0.25)
    assert json.loads(json.dumps(plan.to_json())) == {
        "makespan": 0.0,
        "metric": None,
        "cpu_s": 0.5,
        "wall_s": 0.25,
        "steps": [{"start": 0.0, "action": "a", "args": ["x"], "duration": None}],
    }


def test_all_faults_of_a_plan_are_told() -> None:
    problem = planner.read_problem(MATCH_CELLAR.domain, MATCH_CELLAR.problem)
    with pytest.raises(planner.PddlError) as caught:
        Plan.from_text("0: (light_mach m1) [8]\n1: (light_match f1) [8]\n", problem, "my.plan")
    codes = [diagnostic.code for diagnostic in caught.value.diagnostics]
    assert codes == ["PDDL071", "PDDL030"]
    assert "did you mean `light_match`?" in str(caught.value)
    assert "my.plan:1:5" in str(caught.value)
