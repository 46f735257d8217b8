"""Small temporal problems, and a plan for each, that several tests use."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Example:
    """Domain, problem and a valid plan."""

    name: str
    domain: str
    problem: str
    plan: str


MATCH_CELLAR = Example(
    "match-cellar",
    """(define (domain match-cellar)
  (:requirements :typing :durative-actions :numeric-fluents)
  (:types match fuse - object)
  (:predicates (light ?m - match) (unused ?m - match) (mended ?f - fuse) (handfree))
  (:functions (burning) (mending ?f - fuse))
  (:durative-action light_match :parameters (?m - match)
   :duration (= ?duration (burning))
   :condition (and (at start (unused ?m)) (over all (light ?m)))
   :effect (and (at start (not (unused ?m))) (at start (light ?m)) (at end (not (light ?m)))))
  (:durative-action mend_fuse :parameters (?f - fuse ?m - match)
   :duration (= ?duration (mending ?f))
   :condition (and (at start (handfree)) (over all (light ?m)))
   :effect (and (at start (not (handfree))) (at end (mended ?f)) (at end (handfree)))))
""",
    """(define (problem cellar-2) (:domain match-cellar) (:objects m1 m2 - match f1 f2 - fuse)
  (:init (unused m1) (unused m2) (handfree) (= (burning) 8) (= (mending f1) 3) (= (mending f2) 4))
  (:goal (and (mended f1) (mended f2))) (:metric minimize (total-time)))
""",
    """0.000: (light_match m1) [8.000]
0.001: (mend_fuse f1 m1) [3.000]
3.002: (mend_fuse f2 m1) [4.000]
""",
)

RENDEZVOUS = Example(
    "rendezvous",
    """(define (domain rendezvous)
  (:requirements :typing :durative-actions :numeric-fluents :negative-preconditions :equality)
  (:types robot place - object)
  (:predicates (at ?r - robot ?p - place) (road ?a ?b - place) (met ?r ?s - robot)
    (tired ?r - robot))
  (:functions (length ?a ?b - place) (energy ?r - robot))
  (:durative-action drive :parameters (?r - robot ?a ?b - place)
   :duration (= ?duration (length ?a ?b))
   :condition (and (at start (at ?r ?a)) (at start (road ?a ?b)) (at start (>= (energy ?r) 2)))
   :effect (and (at start (not (at ?r ?a))) (at end (at ?r ?b))
                (at start (decrease (energy ?r) 2))))
  (:durative-action meet :parameters (?r ?s - robot ?p - place)
   :duration (= ?duration 1)
   :condition (and (at start (not (= ?r ?s))) (over all (at ?r ?p)) (over all (at ?s ?p))
                   (at end (not (tired ?r))))
   :effect (and (at end (met ?r ?s))))
  (:action rest :parameters (?r - robot)
   :precondition (and (< (energy ?r) 3))
   :effect (and (increase (energy ?r) 4) (tired ?r)))
  (:action wake :parameters (?r - robot)
   :precondition (tired ?r)
   :effect (not (tired ?r))))
""",
    """(define (problem rendezvous-1) (:domain rendezvous)
  (:objects r1 r2 - robot a b c - place)
  (:init (at r1 a) (at r2 c) (road a b) (road b c) (road c b) (road b a)
    (= (length a b) 5) (= (length b a) 5) (= (length b c) 2.5) (= (length c b) 2.5)
    (= (energy r1) 4) (= (energy r2) 2))
  (:goal (and (met r1 r2) (at r2 c))))
""",
    """0.000: (drive r1 a b) [5.000]
0.000: (drive r2 c b) [2.500]
2.600: (rest r2)
3.000: (wake r2)
5.001: (meet r1 r2 b) [1.000]
6.002: (drive r2 b c) [2.500]
""",
)

WINDOW = Example(
    "window",
    """(define (domain window)
  (:requirements :typing :durative-actions :timed-initial-literals :conditional-effects
    :universal-preconditions :disjunctive-preconditions :negative-preconditions)
  (:types gate crate - object)
  (:predicates (open ?g - gate) (through ?c - crate) (fragile ?c - crate) (broken ?c - crate)
    (lifted ?c - crate) (done))
  (:durative-action push :parameters (?c - crate ?g - gate)
   :duration (= ?duration 2)
   :condition (and (over all (open ?g)) (at start (not (through ?c))))
   :effect (and (at end (through ?c))))
  (:action lift :parameters (?c - crate) :precondition (not (lifted ?c)) :effect (lifted ?c))
  (:action drop :parameters (?c - crate)
   :precondition (lifted ?c)
   :effect (and (not (lifted ?c)) (when (fragile ?c) (broken ?c))))
  (:action report :parameters ()
   :precondition (forall (?c - crate) (or (through ?c) (broken ?c)))
   :effect (done)))
""",
    """(define (problem window-1) (:domain window) (:objects g - gate c1 c2 c3 - crate)
  (:init (fragile c1) (fragile c3) (at 4 (open g)) (at 10 (not (open g))))
  (:goal (done)))
""",
    """0.500: (lift c1)
1.000: (drop c1)
4.500: (push c2 g) [2.000]
6.000: (push c3 g) [2.000]
9.000: (report)
""",
)

EXAMPLES = (MATCH_CELLAR, RENDEZVOUS, WINDOW)
