"""News in the middle of a mission, as problems."""

from planner import Plan, Step, read_domain, read_problem, solve
from scenarios.benchmarks.planner.replanning import blocked, first_of_each, reached

DOMAIN = """
(define (domain floor) (:requirements :typing :durative-actions :numeric-fluents)
 (:types robot place - object explorer clearer - robot spot blockade - place)
 (:predicates (at ?r - robot ?x - place) (cleared ?b - blockade) (explored ?s - spot)
  (reachable ?x ?y - place))
 (:functions (path-cost ?r - robot ?x ?y - place) (blockade-size ?b - blockade))
 (:durative-action go :parameters (?r - robot ?x - spot ?y - place)
  :duration (= ?duration (path-cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (reachable ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action explore :parameters (?r - explorer ?x - spot ?y - spot)
  :duration (= ?duration (path-cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (reachable ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y))))
 (:durative-action explore-from-blockade :parameters (?r - explorer ?x - blockade ?y - spot)
  :duration (= ?duration (path-cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (cleared ?x)) (at start (reachable ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y))))
 (:durative-action clear :parameters (?r - clearer ?b - blockade)
  :duration (= ?duration (blockade-size ?b))
  :condition (over all (at ?r ?b)) :effect (at end (cleared ?b))))
"""
TEXT = """
(define (problem p) (:domain floor)
 (:objects e - explorer c - clearer s t u - spot b - blockade)
 (:init (at e s) (at c s) (reachable s t) (reachable t u)
  (= (path-cost e s t) 100) (= (path-cost c s t) 100)
  (= (path-cost e t u) 50) (= (path-cost c t u) 50)
  (= (path-cost e u t) 50) (= (path-cost c u t) 50))
 (:goal (and (explored t) (explored u))))
"""
STEPS = (
    Step(0.0, "explore", ("e", "s", "t"), 100.0),
    Step(100.001, "explore", ("e", "t", "u"), 50.0),
)
PLAN = Plan(STEPS, "floor", "p")


def test_after_the_first_target_the_rest_of_the_plan_is_a_plan() -> None:
    news = reached(TEXT, PLAN, next(first_of_each(list(STEPS))))
    assert news.rest.steps == STEPS[1:]
    domain = read_domain(DOMAIN)
    best = solve(domain, read_problem(domain, news.problem), warm_start=news.rest).plan
    assert best is not None
    assert best.makespan == 50


def test_a_blockade_before_a_target_has_to_be_cleared() -> None:
    news = blocked(TEXT, PLAN, STEPS[0])
    domain = read_domain(DOMAIN)
    best = solve(domain, read_problem(domain, news.problem), warm_start=news.rest).plan
    assert best is not None
    assert [step.action for step in best.steps].count("clear") == 1
    # To the blockade, clearing, the rest of the way, back and on to the other target.
    assert round(best.makespan) == 90 + 200 + 5 + 5 + 45
