; Exploration with marsupial teams (Wurm, section 3.4.2, figure 3.6).
; Carriers deploy and fetch rovers at meeting points; either kind explores the targets that its terrain allows.
(define (domain marsupial)
  (:requirements :strips :typing :negative-preconditions :equality :durative-actions
    :numeric-fluents :timed-initial-literals)

  (:types
    robot location - object
    carrier rover - robot ; a carrier takes rovers aboard
    target meeting - location)

  ; Durations in seconds; infinite where the robot's class cannot go.
  (:modules
    (pathCost ?r - robot ?s - location ?g - location cost pathCost@libgrid.so)
    (exploreCost ?r - robot ?s - location ?g - location cost exploreCost@libgrid.so)
    (dockCost ?e - rover ?c - carrier cost dockCost@libgrid.so)
    (undockCost ?e - rover ?c - carrier cost undockCost@libgrid.so))

  (:predicates
    (at ?r - robot ?x - location)
    (on ?e - rover ?c - carrier)
    (explored ?t - target)
    (can_explore ?r - robot ?t - target))

  ; num_docked and capacity count rovers; the rest is geometry in the map frame, read by the attachments only.
  (:functions
    (num_docked ?c - carrier)
    (capacity ?c - carrier)
    (x ?l - location)
    (y ?l - location)
    (speed ?r - robot)
    (radius ?r - robot))

  (:durative-action move
    :parameters (?r - robot ?s - location ?g - meeting)
    :duration (= ?duration [pathCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (not (= ?s ?g))))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g))))

  (:durative-action explore
    :parameters (?r - robot ?s - location ?g - target)
    :duration (= ?duration [exploreCost ?r ?s ?g])
    :condition (and
      (at start (at ?r ?s))
      (at start (not (explored ?g)))
      (at start (can_explore ?r ?g))
      (at start (not (= ?s ?g))))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g)) (at start (explored ?g))))

  (:durative-action dock
    :parameters (?e - rover ?c - carrier ?m - meeting)
    :duration (= ?duration [dockCost ?e ?c])
    :condition (and
      (at start (at ?e ?m))
      (over all (at ?c ?m))
      (at start (< (num_docked ?c) (capacity ?c))))
    :effect (and
      (at start (not (at ?e ?m)))
      (at start (increase (num_docked ?c) 1))
      (at end (on ?e ?c))))

  (:durative-action undock
    :parameters (?e - rover ?c - carrier ?m - meeting)
    :duration (= ?duration [undockCost ?e ?c])
    :condition (and (at start (on ?e ?c)) (over all (at ?c ?m)))
    :effect (and
      (at start (not (on ?e ?c)))
      (at end (at ?e ?m))
      (at end (decrease (num_docked ?c) 1)))))
