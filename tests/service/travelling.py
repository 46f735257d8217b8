"""A small temporal domain without attachments, and problems of it as large as one likes."""

DOMAIN = """
(define (domain errands)
  (:requirements :strips :typing :durative-actions :numeric-fluents :negative-preconditions)
  (:types robot place - object)
  (:predicates (at ?r - robot ?p - place) (done ?p - place))
  (:functions (distance ?a ?b - place))
  (:durative-action go
    :parameters (?r - robot ?a ?b - place)
    :duration (= ?duration (distance ?a ?b))
    :condition (and (at start (at ?r ?a)))
    :effect (and (at start (not (at ?r ?a))) (at end (at ?r ?b)) (at end (done ?b)))))
"""


def problem(places: int, robots: int = 2) -> str:
    """Robots that start at p0 and have to be everywhere."""
    names = [f"p{index}" for index in range(places)]
    spots = {name: ((index * 37) % 101, (index * 61) % 97) for index, name in enumerate(names)}
    distances = "\n".join(
        f"(= (distance {a} {b}) {abs(spots[a][0] - spots[b][0]) + abs(spots[a][1] - spots[b][1])})"
        for a in names
        for b in names
        if a != b
    )
    team = [f"r{index}" for index in range(robots)]
    return f"""
(define (problem round) (:domain errands)
  (:objects {" ".join(team)} - robot {" ".join(names)} - place)
  (:init {" ".join(f"(at {robot} p0)" for robot in team)} {distances})
  (:goal (and {" ".join(f"(done {name})" for name in names[1:])})))
"""
