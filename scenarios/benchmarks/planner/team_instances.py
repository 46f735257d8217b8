"""Random problems of the disaster and marsupial families, as plain PDDL with costs as fluents."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

ROOM_M = 120.0
SITE_M = 400.0
DISASTER = """
(define (domain floor)
 (:requirements :typing :durative-actions :numeric-fluents)
 (:types robot place - object explorer clearer - robot spot blockade - place)
 (:predicates (at ?r - robot ?x - place) (cleared ?b - blockade) (explored ?s - spot)
  (way ?x ?y - place))
 (:functions (cost ?r - robot ?x ?y - place) (size ?b - blockade))
 (:durative-action go :parameters (?r - robot ?x - spot ?y - place)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action pass :parameters (?r - robot ?x - blockade ?y - place)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (cleared ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action explore :parameters (?r - explorer ?x ?y - spot)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y))))
 (:durative-action pass-explore :parameters (?r - explorer ?x - blockade ?y - spot)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (cleared ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y))))
 (:durative-action clear :parameters (?r - clearer ?b - blockade)
  :duration (= ?duration (size ?b))
  :condition (and (over all (at ?r ?b)))
  :effect (and (at end (cleared ?b)))))
"""
MARSUPIAL = """
(define (domain carrying)
 (:requirements :typing :durative-actions :numeric-fluents)
 (:types robot place - object carrier rover - robot site target - place)
 (:predicates (at ?r - robot ?x - place) (on ?r - rover ?c - carrier) (explored ?t - target)
  (way ?r - robot ?x ?y - place))
 (:functions (cost ?r - robot ?x ?y - place) (docked ?c - carrier) (room ?c - carrier))
 (:durative-action dock :parameters (?r - rover ?c - carrier ?x - site)
  :duration (= ?duration 20)
  :condition (and (at start (at ?r ?x)) (over all (at ?c ?x)) (at start (< (docked ?c) (room ?c))))
  :effect (and (at start (not (at ?r ?x))) (at end (on ?r ?c)) (at start (increase (docked ?c) 1))))
 (:durative-action undock :parameters (?r - rover ?c - carrier ?x - site)
  :duration (= ?duration 10)
  :condition (and (at start (on ?r ?c)) (over all (at ?c ?x)))
  :effect (and (at start (not (on ?r ?c))) (at end (at ?r ?x)) (at end (decrease (docked ?c) 1))))
 (:durative-action go :parameters (?r - robot ?x - place ?y - site)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?r ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action explore :parameters (?r - robot ?x - place ?y - target)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?r ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y)))))
"""


@dataclass(frozen=True, slots=True)
class Node:
    """A place [m] and the rooms that it touches."""

    name: str
    x_m: float
    y_m: float
    rooms: frozenset[tuple[int, int]] = frozenset()

    def distance_m(self, other: Node) -> float:
        """As the crow flies [m]."""
        return math.hypot(self.x_m - other.x_m, self.y_m - other.y_m)


def disaster(explorers: int, clearers: int, targets: int, blockades: int, seed: int) -> str:
    """A floor of rooms; blockades stand in doors between them.

    Robots know ways that go through open doors. Clearers are half as fast. The domain is
    `DISASTER`.
    """
    random = np.random.default_rng(seed)
    columns = rows = _side(blockades)
    doors = []
    for row in range(rows):
        for column in range(columns):
            x_m, y_m = column * ROOM_M, row * ROOM_M
            here = (column, row)
            if column + 1 < columns:
                y = y_m + ROOM_M * random.uniform(0.2, 0.8)
                doors.append(Node("", x_m + ROOM_M, y, frozenset({here, (column + 1, row)})))
            if row + 1 < rows:
                x = x_m + ROOM_M * random.uniform(0.2, 0.8)
                doors.append(Node("", x, y_m + ROOM_M, frozenset({here, (column, row + 1)})))
    doors = [doors[k] for k in random.permutation(len(doors))]
    spots = []
    names = [f"s{k}" for k in range(explorers + clearers)] + [f"t{k}" for k in range(targets)]
    for name in names:
        room = (int(random.integers(columns)), int(random.integers(rows)))
        x_m, y_m = (ROOM_M * (side + random.uniform(0.1, 0.9)) for side in room)
        spots.append(Node(name, x_m, y_m, frozenset({room})))
    blocked = [
        Node(f"b{k}", door.x_m, door.y_m, door.rooms) for k, door in enumerate(doors[:blockades])
    ]
    places = spots + blocked
    init = []
    for start in places:
        for end, way_m in _ways_m(start, places, doors[blockades:]):
            init.append(f"(way {start.name} {end.name})")
            cost_s = 1 + round(way_m)
            for robots, factor in ((numbered("e", explorers), 1), (numbered("c", clearers), 2)):
                costs = (f"(cost {robot} {start.name} {end.name})" for robot in robots)
                init += [f"(= {cost} {factor * cost_s})" for cost in costs]
    robots = [*numbered("e", explorers), *numbered("c", clearers)]
    init += [f"(at {robot} s{k})" for k, robot in enumerate(robots)]
    init += [f"(= (size {one.name}) {10 * int(random.integers(20, 40))})" for one in blocked]
    objects = {
        "explorer": numbered("e", explorers),
        "clearer": numbered("c", clearers),
        "spot": [one.name for one in spots],
        "blockade": [one.name for one in blocked],
    }
    return problem_text("floor", objects, init, targets)


def _side(blockades: int) -> int:
    """Rooms along a side of the floor, so that most of its doors are blocked."""
    side = 2
    while 2 * side * (side - 1) < 1.2 * blockades:
        side += 1
    return side


def _ways_m(start: Node, places: Sequence[Node], doors: Sequence[Node]) -> list[tuple[Node, float]]:
    """Shortest ways [m] through doors to the places that can be reached (Dijkstra)."""
    nodes = [*places, *doors]
    best = {start: 0.0}
    queue = [(0.0, nodes.index(start))]
    while queue:
        so_far_m, index = heapq.heappop(queue)
        node = nodes[index]
        # Places end a way.
        if so_far_m > best[node] or (node is not start and index < len(places)):
            continue
        for k, other in enumerate(nodes):
            far_m = so_far_m + node.distance_m(other)
            if node.rooms & other.rooms and far_m < best.get(other, math.inf):
                best[other] = far_m
                heapq.heappush(queue, (far_m, k))
    return [(place, best[place]) for place in places if place in best and place is not start]


def marsupial(carriers: int, rovers: int, targets: int, sites: int, seed: int) -> str:
    """Carriers take rovers to sites, around which four of five targets lie; the fifth is theirs.

    Rovers are half as fast as carriers and stay near a site. The domain is `MARSUPIAL`.
    """
    random = np.random.default_rng(seed)
    side_m = SITE_M * math.sqrt(sites)
    at_sites = [Node(f"m{k}", *random.uniform(0, side_m, 2)) for k in range(sites)]
    at_targets = []
    site_of: dict[str, int | None] = {node.name: k for k, node in enumerate(at_sites)}
    for k in range(targets):
        site = k % sites if k % 5 != 4 else None
        site_of[f"t{k}"] = site
        if site is None:
            at_targets.append(Node(f"t{k}", *random.uniform(0, side_m, 2)))
        else:
            offset_m = random.uniform(-ROOM_M, ROOM_M, 2)
            near = at_sites[site]
            at_targets.append(Node(f"t{k}", near.x_m + offset_m[0], near.y_m + offset_m[1]))
    nodes = [*at_sites, *at_targets]
    init = []
    for one in nodes:
        for other in nodes:
            if one is other:
                continue
            cost_s = 1 + round(one.distance_m(other))
            robots: list[tuple[list[str], int]] = []
            if all(node in at_sites or site_of[node.name] is None for node in (one, other)):
                robots.append((numbered("c", carriers), 1))
            if site_of[one.name] is not None and site_of[one.name] == site_of[other.name]:
                robots.append((numbered("r", rovers), 2))
            for names, factor in robots:
                for name in names:
                    way = f"{name} {one.name} {other.name}"
                    init.append(f"(way {way}) (= (cost {way}) {factor * cost_s})")
    for k in range(carriers):
        load = len(range(k, rovers, carriers))
        init.append(f"(at c{k} m{k % sites}) (= (docked c{k}) {load})")
        init.append(f"(= (room c{k}) {max(load, 2) + 1})")
    init += [f"(on r{k} c{k % carriers})" for k in range(rovers)]
    objects = {
        "carrier": numbered("c", carriers),
        "rover": numbered("r", rovers),
        "site": numbered("m", sites),
        "target": numbered("t", targets),
    }
    return problem_text("carrying", objects, init, targets)


def numbered(letter: str, count: int) -> list[str]:
    return [f"{letter}{k}" for k in range(count)]


def problem_text(
    domain: str, objects: dict[str, list[str]], init: Iterable[str], targets: int
) -> str:
    listed = "\n  ".join(f"{' '.join(names)} - {kind}" for kind, names in objects.items())
    facts = "\n  ".join(init)
    goal = " ".join(f"(explored t{k})" for k in range(targets))
    return (
        f"(define (problem team) (:domain {domain})\n (:objects {listed})\n"
        f" (:init {facts})\n (:goal (and {goal})))\n"
    )
