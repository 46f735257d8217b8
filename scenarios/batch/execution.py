"""Executes the runs of a suite, each in a process of its own with limits, and keeps every row.

A row is one line of `runs.jsonl`, written when its run has ended: whatever is killed in between,
the lines that are there are whole, and a resumed suite does only what is missing. A folder that
holds no more than the table of an earlier report, `runs.csv`, is continued from that.
"""

from __future__ import annotations

import csv
import json
import platform
import subprocess
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from importlib.metadata import version
from pathlib import Path
from typing import Any

from scenarios.batch.run_process import run_in_process, stop_runs
from scenarios.batch.suite import RunSpec, Suite

Row = dict[str, Any]
JOURNAL = "runs.jsonl"
TABLE = "runs.csv"
_MISSION_TEXTS = ("key", "suite", "map", "team", "strategy", "status", "reason")
_SOURCE_TEXTS = ("revision", "version", "python", "numpy", "pymunk")
_TEXTS = frozenset((*_MISSION_TEXTS, *_SOURCE_TEXTS))
"""Columns whose values are texts, even where they look like numbers."""


def execute(
    suite: Suite,
    folder: Path,
    *,
    jobs: int = 1,
    resume: bool = False,
    perform: Callable[[Suite, RunSpec], Row] = run_in_process,
) -> Iterator[tuple[int, int]]:
    """Runs what is to be run, yielding (done, of) after each run.

    Raises:
        FileExistsError: there are results and nobody said that they shall be continued.
    """
    folder.mkdir(parents=True, exist_ok=True)
    journal = folder / JOURNAL
    there = [name for name in (JOURNAL, TABLE) if (folder / name).exists()]
    if there and not resume:
        names = " and ".join(there)
        raise FileExistsError(
            f"{folder} has results: continue them with --resume, or remove its {names}"
        )
    done = {row["key"] for row in rows(folder)}
    wanted = suite.runs()
    missing = [spec for spec in wanted if spec.key not in done]
    count = len(wanted) - len(missing)
    yield count, len(wanted)
    provenance = provenance_of()
    with (
        ThreadPoolExecutor(max_workers=jobs) as pool,
        journal.open("a", encoding="utf-8") as file,
    ):
        if journal.stat().st_size and not journal.read_bytes().endswith(b"\n"):
            file.write("\n")  # a kill cut the last line off
        pending: set[Future[Row]] = set()
        queue = iter(missing)
        try:
            while True:
                while len(pending) < jobs and (spec := next(queue, None)) is not None:
                    pending.add(pool.submit(_identified, perform, suite, spec, provenance))
                if not pending:
                    break
                ended, pending = wait(pending, return_when=FIRST_COMPLETED)
                for future in ended:
                    file.write(json.dumps(future.result()) + "\n")
                    file.flush()
                    count += 1
                    yield count, len(wanted)
        finally:
            # None is left unless somebody wants to stop: what has begun would take minutes.
            stop_runs()
            pool.shutdown(wait=True, cancel_futures=True)


def rows(folder: Path) -> list[Row]:
    """The rows so far, in the order of their keys; a line cut off by a kill is left out."""
    journal = folder / JOURNAL
    found = {row["key"]: row for row in _tabled(folder / TABLE)}
    if journal.exists():
        for line in journal.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except ValueError:
                continue
            found[row["key"]] = row
    return [found[key] for key in sorted(found)]


def _tabled(table: Path) -> list[Row]:
    """The rows of a table, their values of the types that they had; a row cut off is left out."""
    if not table.exists():
        return []
    found = []
    with table.open(newline="", encoding="utf-8", errors="replace") as file:
        for texts in csv.DictReader(file):
            if texts.get("key") and None not in texts.values():
                told = {n: _value(n, text) for n, text in texts.items() if text or n in _TEXTS}
                # Of a map that no generator drew.
                told.setdefault("map_seed", None)
                found.append(told)
    return found


def _value(name: str, text: str) -> str | int | float | None:
    if name not in _TEXTS:
        for kind in (int, float):
            try:
                return kind(text)
            except ValueError:
                continue
    return text


def provenance_of() -> Row:
    """What a row says about where it comes from."""
    home = Path(__file__).parents[2]
    words = ["git", "-C", str(home), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        asked = subprocess.run(words, capture_output=True, text=True, check=False)
        revision = asked.stdout.strip()
    except OSError:
        revision = ""
    return {
        "revision": revision or "unknown",
        "version": version("marsupial"),
        "python": platform.python_version(),
        "numpy": version("numpy"),
        "pymunk": version("pymunk"),
    }


def _identified(
    perform: Callable[[Suite, RunSpec], Row], suite: Suite, spec: RunSpec, provenance: Row
) -> Row:
    return {
        "key": spec.key,
        "suite": suite.name,
        "map": spec.map_name,
        "map_seed": spec.map_seed,
        "team": spec.team_name,
        "robots": sum(count for _, count in spec.team),
        "seed": spec.seed,
        "strategy": spec.strategy,
        **perform(suite, spec),
        **provenance,
    }
