"""PDDL names for a mission's ids, and the way back.

Fleets choose ids freely; PDDL knows lower-case names of letters, digits, `-` and `_`. An id that is
such a name stays as it is; every other one becomes the nearest name that nobody else has.
"""

import re
from collections.abc import Iterable

_NAME = re.compile(r"[a-z][a-z0-9_-]*\Z")
_RESERVED = frozenset(
    {"object", "number", "total-time", "total-cost", "and", "or", "not", "at", "over", "all"}
)


class Names:
    """A one-to-one map between ids and PDDL names, the same for the same ids in the same order."""

    def __init__(self, ids: Iterable[str]) -> None:
        self._name_of: dict[str, str] = {}
        self._id_of: dict[str, str] = {}
        ids = list(ids)
        for identifier in sorted(ids, key=lambda text: not self._is_plain(text)):
            self._add(identifier)

    @staticmethod
    def _is_plain(identifier: str) -> bool:
        return bool(_NAME.match(identifier)) and identifier not in _RESERVED

    def _add(self, identifier: str) -> None:
        if identifier in self._name_of:
            raise ValueError(f"the id {identifier!r} names two things: ids of a mission are unique")
        stem = identifier
        if not self._is_plain(identifier):
            stem = re.sub(r"[^a-z0-9_-]", "_", identifier.lower())
            if not self._is_plain(stem):
                stem = f"o_{stem}"
        name, count = stem, 1
        while name in self._id_of:
            count += 1
            name = f"{stem}_{count}"
        self._name_of[identifier] = name
        self._id_of[name] = identifier

    def name(self, identifier: str) -> str:
        """The PDDL name of an id."""
        return self._name_of[identifier]

    def id(self, name: str) -> str:
        """The id behind a PDDL name."""
        return self._id_of[name]

    def agree_with(self, other: "Names") -> bool:
        """Whether every id here has the same name there."""
        return self._name_of.items() <= other._name_of.items()

    def __contains__(self, identifier: str) -> bool:
        return identifier in self._name_of
