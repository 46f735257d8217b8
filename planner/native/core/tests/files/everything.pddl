; every part of the language, in an unusual order
(define (domain Full)
  (:durative-action Move
    :effect (and (at start (not (at ?r ?from))) (at end (at ?r ?to))
                 (at end (decrease (fuel ?r) (* 2 ?duration)))
                 (forall (?o - robot) (when (over all (docked ?o ?r)) (at end (at ?o ?to))))
                 (at end ([unload ?r])))
    :condition (and (at start (at ?r ?from)) (over all ([free ?to]))
                    (at end (>= (fuel ?r) 0))
                    (forall (?o - robot) (and (at start (not (docked ?r ?o))) (over all (ready ?o)))))
    :duration (and (>= ?duration [pathCost ?r ?from ?to]) (<= ?duration 100)
                   (at end (<= ?duration (+ 1 2 (- (fuel ?r))))))
    :parameters (?r - robot ?from ?to - (either place dock)))
  (:action refuel
    :parameters (?r - robot)
    :precondition (or (at ?r base) (imply (ready ?r) (exists (?o - robot) (and (not (= ?o ?r)) (docked ?r ?o)))))
    :effect (and (assign (fuel ?r) 10) (increase (total-cost) 1) (when (ready ?r) (broken ?r))))
  (:derived (ready ?r - robot) (forall (?p - place) (not (at ?r ?p))))
  (:modules
    (pathCost ?r - robot ?from ?to - (either place dock) cost pathCost@libGrid.so)
    (free ?x - (either place dock) conditionchecker free@world.grid:Free)
    (unload ?r - robot (fuel ?r) (total-cost) effect unload@libX.so))
  (:functions (fuel ?r - robot) (total-cost) - number)
  (:predicates (at ?r - robot ?x - (either place dock)) (docked ?a ?b - robot) (ready ?r - robot) (broken ?r - robot))
  (:constants base - dock)
  (:types robot place dock - object small big - robot)
  (:oplinit start@libGrid.so)
  (:requirements :adl :typing :durative-actions :duration-inequalities :numeric-fluents
                 :derived-predicates :timed-initial-literals))
