"""The planner against its peers: disaster and marsupial instances, IPC suites; known optima over
seeds, held-out sizes, replanning, rates, large teams, limits, two threads.

Times are CPU seconds of one engine's processes, from reading the files on. Every plan that counts
has passed the validator. IPC and instance files are read from `../shared/data`; what is absent is
left out and said.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from scenarios.benchmarks.planner import (
    held_out,
    large_team,
    limits,
    optima,
    rates,
    replanning,
    threads,
)
from scenarios.benchmarks.planner.contest import Run, run_engine
from scenarios.benchmarks.planner.engines import installed_engines
from scenarios.benchmarks.planner.instances import Instance, families, ipc_instances
from scenarios.benchmarks.planner.report import markdown
from scenarios.exit_codes import CommandError

DATA = Path("../shared/data")
QUICK_DOMAINS = ("match-cellar", "turn-and-open", "openstacks")
"""Parts of the names of the IPC domains that `--quick` runs, one instance each."""


def run(
    *,
    quick: bool,
    out: Path,
    seconds: float | None = None,
    domains: tuple[str, ...] = (),
    resume: bool = False,
) -> str:
    """Runs every engine on every instance and returns the tables.

    `seconds` is the CPU limit of a run [s]: 30 if None, 2 for `--quick`. `domains` keeps instances
    whose family contains one of these words; `resume` keeps the runs that are in `runs.json`.

    Raises:
        CommandError: nothing that could be run contains one of the words.
    """
    _refuse_unknown(domains, quick=quick)
    limit_s = seconds if seconds is not None else (2.0 if quick else 30.0)
    path = out / "runs.json"
    done = _load(path) if resume else {}
    runs: list[Run] = []
    engines = installed_engines()
    for instance in chosen(quick=quick, domains=domains):
        for engine in engines:
            key = f"{instance.name} {engine} {limit_s:g}"
            if key not in done:
                done[key] = run_engine(engine, instance, limit_s)
                path.write_text(
                    json.dumps({name: each.as_json() for name, each in done.items()}, indent=1),
                    encoding="utf-8",
                )
            runs.append(done[key])
    parts = [markdown(runs, engines, limit_s)]
    for name, part in parts_of(quick=quick).items():
        if not domains or any(word in name for word in domains):
            parts.append(part())
    return "\n\n".join(part for part in parts if part) + "\n"


def parts_of(*, quick: bool) -> dict[str, Callable[[], str]]:
    """What is measured beside the instances, by the word that `--domains` chooses it with."""
    instances = DATA / "instances"
    return {
        "optima": lambda: optima.run(instances, quick=quick),
        "held-out": lambda: held_out.run(quick=quick),
        "replanning": lambda: replanning.run(quick=quick),
        "rates": lambda: rates.run(instances, quick=quick),
        "large-team": lambda: large_team.run(quick=quick),
        "limits": lambda: limits.run(DATA, quick=quick),
        "threads": lambda: threads.run(DATA, quick=quick),
    }


def chosen(*, quick: bool, domains: tuple[str, ...]) -> list[Instance]:
    """The instances to run, in a fixed order."""
    if quick and not domains:
        ipc = [
            instance
            for instance in ipc_instances(DATA / "ipc")
            if instance.number == 1 and any(word in instance.family for word in QUICK_DOMAINS)
        ]
        return families(DATA / "instances") + ipc
    every = families(DATA / "instances") + ipc_instances(DATA / "ipc")
    if not domains:
        return every
    kept = [one for one in every if any(word in one.family for word in domains)]
    # Every tenth is enough to see where a domain stands.
    return [one for one in kept if one.number == 0 or one.number % 10 == 1] if quick else kept


def _refuse_unknown(domains: tuple[str, ...], *, quick: bool) -> None:
    """Raises CommandError for a word that chooses nothing, which would be measured in no time."""
    names = {one.family for one in chosen(quick=False, domains=())} | set(parts_of(quick=quick))
    absent = "" if DATA.is_dir() else f" ({DATA}, where instances are, is absent)"
    for word in domains:
        if not any(word in name for name in names):
            raise CommandError(
                f"--domains {word}: the planner's benchmark has no such family; it has "
                f"{', '.join(sorted(names))}{absent}"
            )


def _load(path: Path) -> dict[str, Run]:
    if not path.is_file():
        return {}
    runs = json.loads(path.read_text(encoding="utf-8"))
    return {name: Run.from_json(each) for name, each in runs.items()}
