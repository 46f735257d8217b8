"""Attachments compiled away: the same plans, judged by unified-planning's validator, too."""

import tomllib
from pathlib import Path

import pytest
import unified_planning.shortcuts as up
from _pytest.mark import ParameterSet
from unified_planning.io import PDDLReader

import planner
from planner.compile_attachments import compile_attachments
from planner.s_expressions import parse, write
from scenarios.map_attachments import map_attachments
from tests.planner.test_facade import COURIER, EASY, ERRANDS, FILL, FULL, Level, pour
from tests.planner.test_validator_agreement import theirs

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:unified_planning")


def test_values_become_fluents_and_infinity_a_guard() -> None:
    problem = planner.read_problem(COURIER, ERRANDS)
    plain = compile_attachments(problem, EASY)
    read = plain.read()
    assert read.domain.modules == []
    assert read.fluents[("waytime", "p0", "p2")] == 5
    assert ("waytime", "p0", "p9") not in read.fluents
    assert ("finite-waytime", "p0", "p2") in read.facts
    assert ("finite-waytime", "p0", "p9") not in read.facts
    assert {fact for fact in read.facts if fact[0] == "open"} == {
        ("open", "p0"),
        ("open", "p1"),
        ("open", "p2"),
    }
    assert (
        planner.solve(read.domain, read).plan
        == planner.solve(COURIER, ERRANDS, attachments=EASY).plan
    )


def test_a_domain_without_modules_stays_as_it_is() -> None:
    problem = planner.read_problem(
        "(define (domain d) (:predicates (p)))",
        "(define (problem q) (:domain d) (:init) (:goal (p)))",
    )
    assert compile_attachments(problem, {}).domain == problem.domain.text


def test_what_depends_on_the_state_is_refused_by_name() -> None:
    problem = planner.read_problem(FILL, FULL)
    with pytest.raises(planner.UnsupportedError, match=r"\[high\] depends on the state"):
        compile_attachments(problem, {"high": Level(), "pour": pour})
    with pytest.raises(planner.UnsupportedError, match=r"effect module \[pour\]"):
        compile_attachments(problem, {"high": lambda: True, "pour": pour})


def test_expressions_read_back() -> None:
    text = "(define (domain d) ; comment\n (:action a :duration (= ?duration [c ?a\n ?b])))"
    assert write(parse(text)) == "(define (domain d) (:action a :duration (= ?duration [c ?a ?b])))"
    wide = write(parse("(and " + "(predicate argument) " * 40 + ")"))
    assert max(map(len, wide.splitlines())) <= 100
    assert parse(wide) == parse(wide.replace("\n", " "))


def examples() -> list[ParameterSet]:
    """The domains' example problems; their reader takes its time for the large ones."""
    quick = {"passage", "annex-1x1"}
    return [
        pytest.param(
            path,
            id=f"{path.parts[-3]}-{path.stem}",
            marks=() if path.stem in quick else pytest.mark.slow,
        )
        for path in sorted((ROOT / "domains").glob("*/problems/*.pddl"))
    ]


@pytest.mark.parametrize("path", examples())
def test_both_validators_accept_our_plans_of_the_examples(path: Path) -> None:
    expected = tomllib.loads((path.parent / "expect.toml").read_text())[path.stem]
    problem = planner.read_problem(path.parents[1] / "domain.pddl", path)
    attachments = map_attachments(problem.domain, problem, path.parent / expected["map"])
    result = planner.solve(
        problem.domain, problem, attachments=attachments, timeout_s=30, first_plan_only=True
    )
    assert result.plan is not None
    plain = compile_attachments(problem, attachments)
    read = plain.read()
    verdict = planner.validate(read.domain, read, result.plan)
    assert verdict, verdict.message
    up.get_environment().credits_stream = None
    other = PDDLReader().parse_problem_string(plain.domain, plain.problem)
    steps = tuple(snapped(list(result.plan)))
    assert theirs(other, planner.Plan(steps)) == (True, "")
    late = planner.Plan((*steps[:-1], planner.Step(0.0, *astuple(steps[-1])[1:])))
    assert theirs(other, late) is not None
    assert not theirs(other, late)[0] or len(steps) == 1  # type: ignore[index]


def astuple(step: planner.Step) -> tuple[float, str, tuple[str, ...], float | None]:
    return step.start, step.action, step.arguments, step.duration


def snapped(steps: list[planner.Step]) -> list[planner.Step]:
    """Starts delayed by a microsecond each: fractions tell apart what binary numbers lose."""
    return [
        planner.Step(round(step.start + 1e-6 * index, 9), *astuple(step)[1:])
        for index, step in enumerate(sorted(steps, key=lambda one: one.start), 1)
    ]
