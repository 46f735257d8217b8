"""Runs an engine of unified-planning in a process of its own, for `planner.peers`.

`python -m planner.peer_process ENGINE TIMEOUT` reads domain.pddl and problem.pddl where it is
started and writes each plan as plan.1, plan.2, ... as soon as the engine gives it. What keeps it
from planning is one line on stderr.
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import Any

from planner.compile_attachments import Compiled

OUTSIDE = {"tamerlite": ("tamerlite.engine", "TamerLite")}
"""Engines that unified-planning does not know by name: module and class."""


def main(name: str, timeout_s: float | None, home: Path) -> None:
    """Plans in this folder."""
    warnings.simplefilter("ignore")
    from unified_planning.io import PDDLReader
    from unified_planning.shortcuts import get_environment

    environment = get_environment()
    environment.credits_stream = None
    if name in OUTSIDE:
        environment.factory.add_engine(name, *OUTSIDE[name])
    domain, problem = home / "domain.pddl", home / "problem.pddl"
    original: dict[str, str] = {}
    if name == "tamer":
        from planner.leaf_types import without_hierarchy

        flat, original = without_hierarchy(Compiled(domain.read_text(), problem.read_text()))
        domain.write_text(flat.domain)
        problem.write_text(flat.problem)
    task = PDDLReader().parse_problem(str(domain), str(problem))
    if name == "aries":
        from planner.integer_fluents import with_integers

        task = with_integers(task)
    for number, plan in enumerate(_plans(name, task, timeout_s), 1):
        (home / "plan.part").write_text(text(plan, original))
        (home / "plan.part").rename(home / f"plan.{number}")


def _plans(name: str, task: Any, timeout_s: float | None) -> Any:
    """Improving plans where the engine has them, else one."""
    from unified_planning.shortcuts import AnytimePlanner, OneshotPlanner, get_environment

    factory = get_environment().factory
    if factory.engine(name).is_anytime_planner():
        with AnytimePlanner(name=name) as planner:
            planner.skip_checks = True
            for result in planner.get_solutions(task, timeout=timeout_s):
                _complain(result)
                if result.plan is not None:
                    yield result.plan
        return
    with OneshotPlanner(name=name) as planner:
        planner.skip_checks = True
        result = planner.solve(task, timeout=timeout_s)
        _complain(result)
        if result.plan is not None:
            yield result.plan


def _complain(result: Any) -> None:
    """Tells why an engine does not take a problem."""
    if result.plan is None and result.status.name in ("UNSUPPORTED_PROBLEM", "INTERNAL_ERROR"):
        messages = [one.message.split("\n")[0] for one in result.log_messages or ()]
        raise RuntimeError("; ".join(messages) or result.status.name.lower())


def complaint(error: Exception) -> str:
    """One line of what went wrong; of a server that broke off (Aries), what the connection says."""
    details = getattr(error, "details", None)
    told = str(details() if callable(details) else error).strip()
    return told.split("\n")[0] or type(error).__name__


def text(plan: Any, original: dict[str, str]) -> str:
    """A plan as PDDL writes it; `original` has the names of renamed actions."""
    lines = []
    for start, action, duration in plan.timed_actions:
        name = original.get(action.action.name, action.action.name)
        words = " ".join((name, *map(str, action.actual_parameters)))
        bracket = "" if duration is None else f" [{float(duration)}]"
        lines.append(f"{float(start)}: ({words}){bracket}\n")
    return "".join(lines)


if __name__ == "__main__":
    try:
        main(sys.argv[1], float(sys.argv[2]) or None, Path.cwd())
    except Exception as error:  # engines raise exceptions of their own
        sys.exit(complaint(error))
