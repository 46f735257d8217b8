; ten seeded faults, see test_check.py
(define (domain rescue)
  (:requirements :typing :durative-actions)
  (:types
    robot location - object
    explorer clearer - robot
    blockade mission_target - location)
  (:predicates
    (at ?r - robot ?l - location)
    (cleared ?b - blockade)
    (explored ?t - mission_target)
    (charged ?r - robot))
  (:functions
    (distance ?from ?to - location)
    (size ?b - blockade))

  (:durative-action move
    :parameters (?r - robot ?from ?to - location)
    :duration (= ?duration (distnace ?from ?to))
    :condition (and
      (at start (at ?r ?from))
      (over all (at ?r ?from))
    :effect (and
      (at start (not (at ?r ?from)))
      (at end (at ?r ?to))))

  (:durative-action clear
    :parameters (?r - clearer ?b - blockade)
    :duration (= ?duration (size ?b))
    :condition (over all (at ?r ?b))
    :effect (cleared ?b))

  (:durative-action explore
    :parameters (?r - explorer ?t - mission_target ?b - blockade)
    :duration (>= ?duration 5)
    :condition (and (over all (at ?r)) (at start (charged ?r)))
    :effect (at end (explord ?t))))
