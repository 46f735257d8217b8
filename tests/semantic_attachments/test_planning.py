"""Attachments inside the planner: plans with path costs, and what becomes of bad attachments."""

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import planner
from semantic_attachments import Attachment, Memory, Parameter, World, bind

DOMAIN = """
(define (domain visits)
  (:requirements :typing :durative-actions :negative-preconditions :equality)
  (:types robot location - object blockade - location)
  (:modules
    (pathCost ?r - robot ?s - location ?g - location cost pathCost@libgrid.so)
    (clearCost ?r - robot ?b - blockade cost clearCost@libgrid.so))
  (:predicates (at ?r - robot ?x - location) (visited ?x - location) (cleared ?b - blockade)
    (free ?x - location))
  (:durative-action move
    :parameters (?r - robot ?s ?g - location)
    :duration (= ?duration [pathCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (free ?s)) (at start (not (= ?s ?g))))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g)) (at end (visited ?g))))
  (:durative-action clear
    :parameters (?r - robot ?b - blockade)
    :duration (= ?duration [clearCost ?r ?b])
    :condition (and (over all (at ?r ?b)) (at start (not (cleared ?b))))
    :effect (and (at end (cleared ?b)) (at end (free ?b)))))
"""
PROBLEM = """
(define (problem east) (:domain visits)
  (:objects robot - robot west also_west east - location door - blockade)
  (:init (at robot west) (free west) (free also_west) (free east))
  (:goal (and (visited east) (visited also_west)))
  (:metric minimize (total-time)))
"""


def test_the_robot_clears_the_door_and_passes(two_rooms: World) -> None:
    domain = planner.read_domain(DOMAIN)
    attachments = bind(domain, two_rooms)
    result = planner.solve(domain, PROBLEM, attachments=attachments, node_limit=500)
    assert result.plan is not None
    names = [(step.action, step.arguments[-1]) for step in result.plan]
    assert names == [("move", "also_west"), ("move", "door"), ("clear", "door"), ("move", "east")]
    costs = attachments["pathcost"]
    ways = [("west", "also_west"), ("also_west", "door"), ("door", "east")]
    expected_s = sum(costs("robot", *way) for way in ways) + 20.0
    assert result.plan.makespan == pytest.approx(expected_s, abs=0.1)


def raises(*_: str) -> float:
    raise RuntimeError("the map is gone")


def sleeps(*_: str) -> float:
    time.sleep(3.0)
    return 1.0


def calls_back(*_: str) -> float:
    """The inner search asks from its own thread, waits for the outer one and runs out of time."""
    return float(planner.solve(DOMAIN, PROBLEM, attachments=_bound[0], timeout_s=5.0).lower_bound)


_bound: list[dict[str, Any]] = []


def mutates(world: World, _: Memory) -> Callable[..., float]:
    def cost(*_: str) -> float:
        world.grid.cells[0, 0] = 100
        return 1.0

    return cost


@pytest.mark.parametrize(
    ("binding", "reason"),
    [
        (lambda *_: raises, "it raised RuntimeError: the map is gone"),
        (lambda *_: sleeps, "it took longer than 0.2 s"),
        (lambda *_: lambda *_: math.nan, "it returned NaN"),
        (lambda *_: lambda *_: -1.0, "a cost is never negative"),
        (lambda *_: lambda *_: "far", "a cost is a number"),
        (mutates, "it raised ValueError: assignment destination is read-only"),
        (lambda *_: calls_back, ""),
    ],
)
def test_a_bad_attachment_stops_planning_and_is_named(
    two_rooms: World, binding: Callable[..., Any], reason: str
) -> None:
    parameters = (Parameter("robot"), Parameter("from"), Parameter("to"))
    bad = Attachment("pathCost", parameters, binding)
    domain = planner.read_domain(DOMAIN)
    bound = bind(domain, two_rooms, attachments=[bad], time_limit_s=0.2)
    _bound[:] = [bound]
    with pytest.raises(planner.AttachmentError) as caught:
        planner.solve(domain, PROBLEM, attachments=bound, timeout_s=5.0)
    error = caught.value
    assert error.module.lower() == "pathcost"
    assert error.arguments[0] == "robot"
    assert len(error.arguments) == 3
    assert "move" in error.action
    assert reason in str(error)


def test_the_call_at_fault_is_named(two_rooms: World) -> None:
    def cost(_: str, start: str, goal: str) -> float:
        return float(np.nan if (start, goal) == ("west", "east") else 1.0)

    parameters = (Parameter("robot"), Parameter("from"), Parameter("to"))
    bad = Attachment("pathCost", parameters, lambda *_: cost)
    domain = planner.read_domain(DOMAIN)
    with pytest.raises(planner.AttachmentError) as caught:
        planner.solve(domain, PROBLEM, attachments=bind(domain, two_rooms, attachments=[bad]))
    assert caught.value.arguments == ("robot", "west", "east")
