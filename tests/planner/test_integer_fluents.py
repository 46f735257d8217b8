"""Integers instead of real numbers, none of them without a value."""

from pathlib import Path
from typing import Any

import pytest
from unified_planning.io import PDDLReader

import planner
from planner.integer_fluents import FractionError, with_integers
from planner.unified_planning_translation import Translation

DOMAIN = """
(define (domain trips)
 (:requirements :typing :durative-actions :numeric-fluents)
 (:types place)
 (:predicates (at ?p - place))
 (:functions (length ?p ?q - place) (fuel))
 (:action fill :parameters (?p - place)
  :precondition (and (at ?p) (< (fuel) 1)) :effect (increase (fuel) 9))
 (:durative-action go :parameters (?p ?q - place)
  :duration (= ?duration (length ?p ?q))
  :condition (and (at start (at ?p)) (at start (>= (fuel) (length ?p ?q))))
  :effect (and (at start (not (at ?p))) (at end (at ?q))
   (at start (decrease (fuel) (length ?p ?q))))))
"""
PROBLEM = """
(define (problem one) (:domain trips) (:objects a b c - place)
 (:init (at a) (= (fuel) 0) (= (length a b) 3) (= (length b c) LENGTH)) (:goal (at c)))
"""


def read(folder: Path, length: str = "4") -> Any:
    (folder / "domain.pddl").write_text(DOMAIN)
    (folder / "problem.pddl").write_text(PROBLEM.replace("LENGTH", length))
    return PDDLReader().parse_problem(str(folder / "domain.pddl"), str(folder / "problem.pddl"))


def test_every_number_is_an_integer_with_a_value(tmp_path: Path) -> None:
    problem = with_integers(read(tmp_path))
    assert not any(fluent.type.is_real_type() for fluent in problem.fluents)
    assert {"REAL_FLUENTS", "UNDEFINED_INITIAL_NUMERIC"}.isdisjoint(problem.kind.features)


def test_a_value_that_was_not_given_is_not_read(tmp_path: Path) -> None:
    # Ways of unknown length would have length 0 and make the shortest plan.
    problem = Translation(with_integers(read(tmp_path)), {}).problem
    plan = planner.solve(problem.domain, problem).plan
    assert plan is not None
    assert plan.makespan == pytest.approx(7, abs=0.01)
    assert [step.action for step in plan.steps] == ["fill", "go", "go"]


def test_a_fraction_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(FractionError, match=r"length\(b, c\) is 9/2, which is not an integer"):
        with_integers(read(tmp_path, "4.5"))
