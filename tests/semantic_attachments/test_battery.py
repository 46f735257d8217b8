"""The battery attachments: the worked example of a power constraint."""

import numpy as np
import pytest

import planner
from semantic_attachments import EvaluationError, GridMap, Location, RobotModel, World, bind

DOMAIN = """
(define (domain patrol)
  (:requirements :typing :durative-actions :negative-preconditions :equality :numeric-fluents)
  (:types robot location - object)
  (:modules
    (pathCost ?r - robot ?s - location ?g - location cost pathCost@libgrid.so)
    (enoughCharge ?r - robot ?s - location ?g - location
      conditionchecker enoughCharge@libbattery.so)
    (drain ?r - robot ?s - location ?g - location (charge ?r) effect drain@libbattery.so))
  (:predicates (at ?r - robot ?x - location) (visited ?x - location) (charger ?x - location))
  (:functions (charge ?r - robot) (full ?r - robot))
  (:durative-action move
    :parameters (?r - robot ?s ?g - location)
    :duration (= ?duration [pathCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (not (= ?s ?g)))
                    (at start ([enoughCharge ?r ?s ?g])))
    :effect (and (at start (not (at ?r ?s))) (at start ([drain ?r ?s ?g]))
                 (at end (at ?r ?g)) (at end (visited ?g))))
  (:durative-action recharge
    :parameters (?r - robot ?x - location)
    :duration (= ?duration 30)
    :condition (and (over all (at ?r ?x)) (at start (charger ?x)))
    :effect (at end (assign (charge ?r) (full ?r)))))
"""
PROBLEM = """
(define (problem round) (:domain patrol)
  (:objects robot - robot dock left right - location)
  (:init (at robot dock) (charger dock) (= (charge robot) {charge}) (= (full robot) 100))
  (:goal (and (visited left) (visited right)))
  (:metric minimize (total-time)))
"""


@pytest.fixture
def corridor() -> World:
    """A charger in the middle of a corridor, a place 40 m to either side; the robot does 1 m/s."""
    places = {
        "dock": Location((50.5, 1.5), charger=True),
        "left": Location((10.5, 1.5)),
        "right": Location((90.5, 1.5)),
    }
    grid = GridMap(np.zeros((3, 101), np.int8), resolution_m=1.0)
    return World(grid, places, {"robot": RobotModel("robot", radius_m=0.4, speed_m_s=1.0)})


def actions(corridor: World, charge_s: float) -> list[str] | None:
    domain = planner.read_domain(DOMAIN)
    problem = PROBLEM.format(charge=charge_s)
    attachments = bind(domain, corridor, time_limit_s=None)
    result = planner.solve(domain, problem, attachments=attachments, node_limit=2000)
    return None if result.plan is None else [step.action for step in result.plan]


@pytest.mark.parametrize(
    ("charge_s", "expected"),
    [
        # There and back and there again: 40 + 80, and 40 to get back to the charger.
        (160, ["move", "move"]),
        (159, ["move", "move", "recharge", "move"]),
        (80, ["move", "move", "recharge", "move"]),
        (79, ["recharge", "move", "move", "recharge", "move"]),
    ],
)
def test_a_robot_charges_when_it_has_to(
    corridor: World, charge_s: float, expected: list[str]
) -> None:
    assert actions(corridor, charge_s) == expected


class State:
    def __init__(self, charge_s: float | None) -> None:
        self.charge_s = charge_s

    def value(self, function: str, *arguments: str) -> float | None:
        assert (function, arguments) == ("charge", ("robot",))
        return self.charge_s

    def holds(self, *_: str) -> bool:
        raise AssertionError


def test_what_is_left_after_the_way(corridor: World) -> None:
    bound = bind(["enoughCharge", "drain"], corridor)
    way = ("robot", "dock", "left")
    assert bound["enoughCharge"](State(80.0), *way) == 1.0
    assert bound["enoughCharge"](State(79.9), *way) == 0.0
    assert bound["drain"](State(80.0), *way) == [40.0]
    assert bound["drain"](State(39.0), *way) is None
    with pytest.raises(EvaluationError, match=r"\(charge robot\) has no value"):
        bound["enoughCharge"](State(None), *way)
