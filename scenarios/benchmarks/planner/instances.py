"""Which problems are run."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

OPTIMA_S = {
    "d01-1x1-t3-b2": 690.0,
    "d03-2x2-t6-b4": 692.0,
    "d04-3x2-t6-b3": 1174.0,
    "d06-3x2-t10-b10": 1994.0,
    "d07-3x2-t15-b18": 2074.0,
    "m01-1c1r-t3": 1687.0,
    "m02-1c2r-t6": 1711.0,
    "m03-2c4r-t8": 794.0,
    "m04-3c6r-t12": 759.0,
}
"""Least makespans known [s]."""


@dataclass(frozen=True, slots=True)
class Instance:
    """One problem."""

    family: str
    """`disaster`, `marsupial`, or year and IPC domain."""
    name: str
    domain: Path
    problem: Path
    number: int = 0
    """Of an IPC instance, from 1; 0 for others."""


def families(folder: Path) -> list[Instance]:
    """The disaster and marsupial instances; none where the folder is absent."""
    found = []
    for family in ("disaster", "marsupial"):
        for problem in sorted((folder / family).glob("*.pddl")):
            if problem.name != "domain.pddl":
                domain = problem.with_name("domain.pddl")
                found.append(Instance(family, problem.stem, domain, problem))
    return found


def ipc_instances(folder: Path) -> list[Instance]:
    """Temporal-satisficing instances by year, domain, number; none where the folder is absent."""
    found = []
    for home in sorted(folder.glob("ipc-*/domains/*temporal-satisficing*")):
        year = home.parents[1].name.removeprefix("ipc-")
        short = re.sub(r"-temporal-satisficing(-strips)?", "", home.name)
        family = f"{year} {short}"
        for problem in sorted((home / "instances").glob("instance-*.pddl"), key=_number):
            number = _number(problem)
            own = home / "domains" / f"domain-{number}.pddl"
            domain = own if own.is_file() else home / "domain.pddl"
            name = f"{family} {number}"
            found.append(Instance(family, name, domain, problem, number))
    return found


def _number(path: Path) -> int:
    digits = re.search(r"\d+", path.stem)
    return int(digits[0]) if digits else 0
