"""Flat types: the same plans under other names."""

import pytest

import planner
from planner.compile_attachments import Compiled
from planner.leaf_types import typed_names, without_hierarchy
from planner.s_expressions import parse
from planner.solving import Space

DOMAIN = """
(define (domain transit)
 (:requirements :typing :durative-actions :numeric-fluents :derived-predicates)
 (:types truck ship - vehicle town port - place port - place vehicle place parcel - object)
 (:constants capital - town)
 (:predicates (at ?x - (either vehicle parcel) ?p - place) (in ?b - parcel ?v - vehicle)
  (way ?v - vehicle ?p ?q - place) (known ?p - place))
 (:functions (length ?p ?q - place) - number)
 (:derived (known ?p - place) (exists (?v - vehicle) (at ?v ?p)))
 (:durative-action go :parameters (?v - vehicle ?p ?q - place)
  :duration (= ?duration (length ?p ?q))
  :condition (and (at start (at ?v ?p)) (at start (way ?v ?p ?q)) (at start (not (= ?p ?q))))
  :effect (and (at start (not (at ?v ?p))) (at end (at ?v ?q))))
 (:durative-action load :parameters (?b - parcel ?v - vehicle ?p - place)
  :duration (= ?duration 1)
  :condition (and (at start (at ?b ?p)) (over all (at ?v ?p)))
  :effect (and (at start (not (at ?b ?p))) (at end (in ?b ?v))))
 (:durative-action unload :parameters (?b - parcel ?v - vehicle ?p - place)
  :duration (= ?duration 1)
  :condition (and (at start (in ?b ?v)) (over all (at ?v ?p)))
  :effect (and (at start (not (in ?b ?v))) (at end (at ?b ?p)))))
"""
PROBLEM = """
(define (problem one) (:domain transit)
 (:objects t - truck s - ship harbour island - port b - parcel)
 (:init (at t capital) (at s harbour) (at b capital)
  (way t capital harbour) (way s harbour island)
  (= (length capital harbour) 5) (= (length harbour island) 10))
 (:goal (and (at b island) (forall (?v - vehicle) (exists (?p - port) (at ?v ?p))))))
"""


@pytest.fixture(scope="module")
def flat() -> tuple[Compiled, dict[str, str]]:
    return without_hierarchy(Compiled(DOMAIN, PROBLEM))


def test_there_is_no_hierarchy_left(flat: tuple[Compiled, dict[str, str]]) -> None:
    problem = flat[0].read()
    assert {kind for types in problem.objects.values() for kind in types} == {
        "town",
        "port",
        "truck",
        "ship",
        "parcel",
    }
    assert {parent for above in problem.domain.types.values() for parent in above} <= {"object"}


def test_optima_are_the_same(flat: tuple[Compiled, dict[str, str]]) -> None:
    whole = planner.solve(DOMAIN, PROBLEM, space=Space.DECISION_EPOCHS)
    renamed = planner.solve(flat[0].domain, flat[0].problem, space=Space.DECISION_EPOCHS)
    assert whole.plan is not None
    assert renamed.plan is not None
    # Load, drive, unload, load, sail, unload; epsilons aside.
    assert whole.plan.makespan == pytest.approx(19, abs=0.1)
    assert renamed.plan.makespan == pytest.approx(whole.plan.makespan, abs=1e-6)


def test_original_names_make_a_plan_of_the_original(
    flat: tuple[Compiled, dict[str, str]],
) -> None:
    compiled, original = flat
    plan = planner.solve(compiled.domain, compiled.problem, first_plan_only=True).plan
    assert plan is not None
    text = plan.to_text()
    assert "(go--" in text
    for new in sorted(original, key=len, reverse=True):
        text = text.replace(f"({new} ", f"({original[new]} ")
    problem = planner.read_problem(planner.read_domain(DOMAIN), PROBLEM)
    assert planner.validate(problem.domain, problem, planner.read_plan(problem, text)).valid


def test_typed_lists_as_pddl_has_them() -> None:
    words = parse("(?a ?b - town ?c - (either town port) ?d)")
    assert list(typed_names(words)) == [
        ("?a", ("town",)),
        ("?b", ("town",)),
        ("?c", ("town", "port")),
        ("?d", ("object",)),
    ]
