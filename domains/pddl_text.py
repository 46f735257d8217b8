"""Writes a PDDL problem."""

from collections import defaultdict

from domains.naming import Names


class ProblemText:
    """Collects objects, facts, fluents, timed literals and goals of a problem; takes the mission's
    ids."""

    def __init__(self, name: str, domain: str, names: Names) -> None:
        self._name = name
        self._domain = domain
        self._names = names
        self._objects: dict[str, list[str]] = defaultdict(list)
        self._init: list[str] = []
        self._goals: list[str] = []

    def _atom(self, predicate: str, ids: tuple[str, ...]) -> str:
        return (
            "(" + " ".join([predicate, *(self._names.name(identifier) for identifier in ids)]) + ")"
        )

    def add_object(self, identifier: str, type_name: str) -> None:
        """Declares an object."""
        self._objects[type_name].append(self._names.name(identifier))

    def fact(self, predicate: str, *ids: str) -> None:
        """A fact true at the start."""
        self._init.append(self._atom(predicate, ids))

    def fluent(self, function: str, *ids: str, value: float) -> None:
        """A numeric fluent's value at the start."""
        self._init.append(f"(= {self._atom(function, ids)} {value:.12g})")

    def timed_fact(self, time_s: float, predicate: str, *ids: str) -> None:
        """A fact that becomes true by itself."""
        self._init.append(f"(at {time_s:.3f} {self._atom(predicate, ids)})")

    def goal(self, predicate: str, *ids: str) -> None:
        """A conjunct of the goal."""
        self._goals.append(self._atom(predicate, ids))

    def render(self) -> str:
        """The problem as text."""
        objects = "\n".join(
            f"    {' '.join(names)} - {type_name}"
            for type_name, names in sorted(self._objects.items())
        )
        init = "\n".join(f"    {line}" for line in self._init)
        goals = "\n".join(f"    {line}" for line in self._goals)
        return (
            f"(define (problem {self._name})\n  (:domain {self._domain})\n"
            f"  (:objects\n{objects})\n  (:init\n{init})\n  (:goal (and\n{goals}))\n"
            "  (:metric minimize (total-time)))\n"
        )
