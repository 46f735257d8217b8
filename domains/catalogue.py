"""Finds domains by folder name."""

import difflib
import importlib
from functools import cache
from pathlib import Path

from domains.formulation import Formulation

ROOT = Path(__file__).parent


class UnknownDomainError(LookupError):
    """No folder of this name holds a domain."""


def available() -> list[str]:
    """Names of all domains, sorted."""
    return sorted(path.parent.name for path in ROOT.glob("*/domain.pddl"))


@cache
def load(name: str) -> Formulation:
    """The formulation of the domain called `name`.

    Raises:
        UnknownDomainError: with the names there are, and the nearest one.
    """
    names = available()
    if name not in names:
        near = difflib.get_close_matches(name, names, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise UnknownDomainError(f"no domain {name!r}: there are {', '.join(names)}{hint}")
    formulation = importlib.import_module(f"domains.{name}.formulation").FORMULATION
    if not isinstance(formulation, Formulation):
        raise TypeError(f"domains/{name}/formulation.py: FORMULATION is not a Formulation")
    return formulation
