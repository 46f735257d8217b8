"""Reads the words of `marsupial plan` where they are plain: known options with sound values.

The command line library that reads all others, and explains what is wrong with them, takes longer
to import than a first plan to find. A test holds the two to the same requests.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from planner.commands.plan_run import Engine, Outputs, PlanRequest
from planner.solving import Heuristic, Limits, Space


def _at_least(least: int, kind: Callable[[str], Any]) -> Callable[[str], Any]:
    def read(word: str) -> Any:
        value = kind(word)
        if not value >= least:
            raise ValueError(word)
        return value

    return read


OPTIONS: dict[str, Callable[[str], Any]] = {
    "timeout": _at_least(0, float),
    "cpu-timeout": _at_least(0, float),
    "plan-file": Path,
    "map": Path,
    "seed": _at_least(0, int),
    "threads": _at_least(1, int),
    "node-limit": _at_least(1, int),
    "memory-limit": _at_least(1, int),
    "json": Path,
    "svg": Path,
    "html": Path,
    "engine": Engine,
    "heuristic": Heuristic,
    "space": Space,
}
FLAGS = ("first", "watch")


def plain_request(words: Sequence[str]) -> PlanRequest | None:
    """The request that the words after `plan` make; None where they are anything but plain."""
    files: list[Path] = []
    given: dict[str, Any] = {}
    rest = iter(words)
    for word in rest:
        if not word.startswith("-"):
            files.append(Path(word))
            continue
        option, equals, value = word.removeprefix("--").partition("=")
        if not word.startswith("--") or option in given:
            return None
        if option in FLAGS and not equals:
            given[option] = True
        elif option in OPTIONS:
            text = value if equals else next(rest, "-")
            if text.startswith("-"):
                return None
            try:
                given[option] = OPTIONS[option](text)
            except ValueError:
                return None
        else:
            return None
    if len(files) != 2:
        return None
    limits = Limits(
        timeout_s=given.get("timeout", 10.0) or None,
        seed=given.get("seed", 0),
        threads=given.get("threads", 1),
        node_limit=given.get("node-limit"),
        memory_limit_mb=given.get("memory-limit"),
        first_plan_only=given.get("first", False),
        cpu_timeout_s=given.get("cpu-timeout"),
        heuristic=given.get("heuristic"),
        space=given.get("space", Space.PORTFOLIO),
    )
    outputs = Outputs(*(given.get(name) for name in ("plan-file", "json", "svg", "html")))
    return PlanRequest(
        domain=files[0],
        problem=files[1],
        map=given.get("map"),
        limits=limits,
        outputs=outputs,
        watch=given.get("watch", False),
        engine=given.get("engine", Engine.MARSUPIAL),
    )
