"""Domains, problems and plans from paths, texts or what was read before."""

import os
from pathlib import Path
from typing import TypeAlias

from planner import _core
from planner._core import Domain, Problem
from planner.diagnostics import PddlError, PlannerError, without_panics
from planner.outcome import Outcome
from planner.plan import Plan

DomainLike: TypeAlias = Domain | Path | str
"""A domain, the path of its file, or its text (told by its opening parenthesis or comment)."""
ProblemLike: TypeAlias = Problem | Path | str
PlanLike: TypeAlias = Plan | Path | str


class InputError(PlannerError):
    """A file that cannot be read, or an option that makes no sense."""

    outcome = Outcome.INPUT_ERROR


def read_domain(text: DomainLike | bytes, name: str = "domain.pddl") -> Domain:
    """Reads a domain from its text or file; `name` is shown in diagnostics of texts.

    Raises `PddlError` with all diagnostics of the text; warnings alone raise nothing (`diagnose`
    lists them).
    """
    if isinstance(text, Domain):
        return text
    content, name = _content(text, name)
    with without_panics():
        domain, diagnostics = _core.read_domain(content, name)
    if domain is None:
        raise PddlError(diagnostics)
    return domain


def read_problem(
    domain: DomainLike, text: ProblemLike | bytes, name: str = "problem.pddl"
) -> Problem:
    """Reads a problem against its domain; raises `PddlError` as `read_domain` does."""
    if isinstance(text, Problem):
        return text
    domain = read_domain(domain)
    content, name = _content(text, name)
    with without_panics():
        problem, diagnostics = _core.read_problem(domain, content, name)
    if problem is None:
        raise PddlError(diagnostics)
    return problem


def read_plan(problem: Problem, text: PlanLike | bytes, name: str = "plan") -> Plan:
    """Reads a plan against its problem; raises `PddlError` as `read_domain` does."""
    if isinstance(text, Plan):
        return text
    content, name = _content(text, name)
    return Plan.from_text(content, problem, name)


def _content(text: Path | str | bytes, name: str) -> tuple[bytes, str]:
    """Bytes of a text or file, and the name for diagnostics."""
    if isinstance(text, bytes):
        return text, name
    if isinstance(text, str) and _is_text(text):
        return text.encode(), name
    try:
        return Path(text).read_bytes(), os.fspath(text)
    except OSError as error:
        raise InputError(f"cannot read {os.fspath(text)!r}: {error.strerror or error}") from error


def _is_text(text: str) -> bool:
    """PDDL and plans have parentheses, comments or line breaks; paths have neither at their
    start.
    """
    return "\n" in text or text.lstrip()[:1] in {"(", ";", ""} or ": (" in text or ":(" in text
