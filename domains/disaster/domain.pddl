; Disaster recovery in a partly collapsed building (Wurm, section 3.5.2, figure 3.7).
; Explorers visit mission targets; clearers remove blockades. There are four kinds of movement: to a
; mission target (explore) or elsewhere (move), from free space or from a cleared blockade.
(define (domain disaster)
  (:requirements :strips :typing :negative-preconditions :equality :durative-actions
    :numeric-fluents :timed-initial-literals)

  (:types
    robot location - object
    clearer explorer - robot
    free_location blockade - location
    mission_target - free_location)

  ; Durations in seconds. Every known blockade is a wall on the way from ?s to ?g, save ?s and ?g themselves.
  (:modules
    (pathCost ?r - robot ?s - location ?g - location cost pathCost@libgrid.so)
    (clearCost ?r - clearer ?b - blockade cost clearCost@libgrid.so))

  (:predicates
    (at ?r - robot ?x - location)
    (cleared ?b - blockade)
    (explored ?t - mission_target))

  ; Geometry in the map frame, read by the attachments only [m, m/s, s].
  (:functions
    (x ?l - location)
    (y ?l - location)
    (x-from ?b - blockade)
    (y-from ?b - blockade)
    (x-to ?b - blockade)
    (y-to ?b - blockade)
    (clear-duration ?b - blockade)
    (speed ?r - robot)
    (radius ?r - robot))

  (:durative-action move
    :parameters (?r - robot ?s - free_location ?g - location)
    :duration (= ?duration [pathCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (not (= ?s ?g))))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g))))

  (:durative-action move-from-blockade
    :parameters (?r - robot ?s - blockade ?g - location)
    :duration (= ?duration [pathCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (cleared ?s)) (at start (not (= ?s ?g))))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g))))

  (:durative-action explore
    :parameters (?r - explorer ?s - free_location ?g - mission_target)
    :duration (= ?duration [pathCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (not (explored ?g))) (at start (not (= ?s ?g))))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g)) (at start (explored ?g))))

  (:durative-action explore-from-blockade
    :parameters (?r - explorer ?s - blockade ?g - mission_target)
    :duration (= ?duration [pathCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (not (explored ?g))) (at start (cleared ?s)))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g)) (at start (explored ?g))))

  (:durative-action clear
    :parameters (?c - clearer ?b - blockade)
    :duration (= ?duration [clearCost ?c ?b])
    :condition (and (over all (at ?c ?b)) (at start (not (cleared ?b))))
    :effect (and (at end (cleared ?b)))))
