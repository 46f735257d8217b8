"""Other planners on the same problem, for comparison; each is an optional extra with its own
licence.

Attachments are compiled away into numeric fluents first. What a peer answers goes through our
validator; a plan that it rejects is dropped and counted.

| engine | package | licence | takes |
|---|---|---|---|
| kairos | kairos-planner | none stated in its metadata | temporal, numeric |
| lpg | up-lpg (its LPG-td program) | Apache-2.0 (the adapter) | temporal, numeric |
| aries | up-aries | MIT | temporal, integers |
| tamer | up-tamer (on pytamer) | free for educational use only | temporal |
| tamerlite | tamerlite | GPL-3.0 | temporal; needs a development unified-planning |

The last three run through unified-planning in a process of their own. For Tamer the hierarchy of
types is compiled away, for Aries real fluents that hold integers become integer ones.
"""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

from planner._core import Problem
from planner.attachments import Attachments
from planner.compile_attachments import compile_attachments
from planner.diagnostics import PddlError, PlannerError
from planner.outcome import Outcome
from planner.plan import Plan
from planner.reading import InputError, read_plan
from planner.solving import Result, Statistics
from planner.validation import validate

_STEP = re.compile(r"^\s*([\d.]+)\s*:\s*(\([^)]*\))\s*\[\s*([\d.]+)\s*\]", re.MULTILINE)


class PeerError(PlannerError):
    """A peer that is not installed or failed."""

    outcome = Outcome.UNSUPPORTED


@dataclass(frozen=True, slots=True)
class Peer:
    """How to get at a peer."""

    package: str
    """To install."""
    module: str | None
    """To find it by, if it is a Python package."""
    command: str | None = None
    """To find it by, if it is a program."""
    licence: str = ""


PEERS = {
    "kairos": Peer("kairos-planner", None, "kairos"),
    "lpg": Peer("up-lpg", "up_lpg"),
    "aries": Peer("up-aries", "up_aries", licence="MIT"),
    "tamer": Peer("up-tamer", "up_tamer", licence="free for educational use only"),
    "tamerlite": Peer("tamerlite[rust]", "tamerlite", licence="GPL-3.0"),
}


def solve_with_peer(
    name: str, problem: Problem, attachments: Attachments, timeout_s: float | None
) -> Result:
    """Runs a peer; raises `PeerError` with one sentence where it is not installed."""
    peer = PEERS[name]
    where = find_peer(name, peer)
    plain = compile_attachments(problem, attachments)
    begun = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="marsupial-peer-") as folder:
        home = Path(folder)
        (home / "domain.pddl").write_text(plain.domain)
        (home / "problem.pddl").write_text(plain.problem)
        if name == "kairos":
            texts = _run_kairos(where, home, timeout_s)
        elif name == "lpg":
            texts = _run_lpg(where, home, timeout_s)
        else:
            texts = _run_through_unified_planning(name, home, timeout_s)
        plans = list(_valid(name, texts, problem, attachments))
    wall_s = time.monotonic() - begun
    outcome = Outcome.SOLVED if plans else Outcome.TIMED_OUT
    return Result(
        outcome,
        tuple(sorted(plans, key=lambda plan: -plan.makespan)),
        0.0,
        Statistics(wall_s=wall_s, cpu_s=time.process_time()),
    )


def find_peer(name: str, peer: Peer) -> str:
    """The program or package folder."""
    if peer.command is not None:
        # A program installed beside this Python is found without an activated environment.
        path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
        where = shutil.which(peer.command, path=path)
    else:
        spec = find_spec(peer.module or "")
        folders = spec.submodule_search_locations if spec is not None else None
        where = folders[0] if folders else None
    if where is None:
        licence = f" (licence: {peer.licence})" if peer.licence else ""
        raise PeerError(f"the engine {name} is not installed: pip install {peer.package}{licence}")
    return where


def _run(
    command: list[str],
    home: Path,
    timeout_s: float | None,
    environment: dict[str, str] | None = None,
) -> str:
    """Runs a program in its folder; it gets a few seconds more than its own limit.

    Returns the last line that a program which fails by itself writes to stderr.
    """
    limit_s = None if timeout_s is None else timeout_s + 5
    with (home / "stderr").open("wb") as stderr:
        try:
            process = subprocess.Popen(
                command,
                cwd=home,
                env={**os.environ, **(environment or {})},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                start_new_session=True,
            )
        except OSError as error:
            raise PeerError(f"cannot run {command[0]}: {error.strerror}") from error
        try:
            code = process.wait(limit_s)
        except subprocess.TimeoutExpired:
            return ""
        finally:
            # Engines start programs of their own, which would go on.
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    lines = (home / "stderr").read_text(errors="replace").strip().splitlines()
    return lines[-1] if code > 0 and lines else ""


def _run_kairos(program: str, home: Path, timeout_s: float | None) -> list[str]:
    limit = [] if timeout_s is None else ["--timeout", f"{timeout_s:g}"]
    files = ["domain.pddl", "problem.pddl", "--output", "plan", "--threads", "1"]
    _run([program, "solve", *files, *limit], home, timeout_s)
    return _texts(home, "plan.*")


def _run_lpg(package: str, home: Path, timeout_s: float | None) -> list[str]:
    program = home / "lpg"
    shutil.copy(Path(package) / "lpg", program)
    program.chmod(0o700)
    limit = [] if timeout_s is None else ["-cputime", f"{timeout_s:g}"]
    files = ["-o", "domain.pddl", "-f", "problem.pddl", "-out", "plan", "-n", "1000"]
    _run([str(program), *files, *limit, "-seed", "1"], home, timeout_s)
    return _texts(home, "plan_*.SOL")


def _texts(home: Path, pattern: str) -> list[str]:
    """The plan files' steps: some write brackets that do not match, all write comments."""
    files = sorted(home.glob(pattern), key=lambda path: path.stat().st_mtime_ns)
    return [
        "".join(f"{start}: {action} [{duration}]\n" for start, action, duration in steps)
        for steps in (_STEP.findall(path.read_text(errors="replace")) for path in files)
        if steps
    ]


def _run_through_unified_planning(name: str, home: Path, timeout_s: float | None) -> list[str]:
    command = [sys.executable, "-m", "planner.peer_process", name, f"{timeout_s or 0:g}"]
    # The process runs in another folder, where this package must be found too.
    paths = (str(Path(__file__).parents[1]), *sys.path)
    complaint = _run(command, home, timeout_s, {"PYTHONPATH": os.pathsep.join(filter(None, paths))})
    files = sorted(home.glob("plan.*[0-9]"), key=lambda path: int(path.suffix[1:]))
    if complaint and not files:
        raise PeerError(f"the engine {name} refuses the problem: {complaint}")
    return [path.read_text() for path in files]


def _valid(
    name: str, texts: list[str], problem: Problem, attachments: Attachments
) -> Iterator[Plan]:
    """The plans that our validator accepts; the others are told on stderr."""
    for number, text in enumerate(texts, 1):
        try:
            plan = read_plan(problem, text, f"{name} plan {number}")
        except (PddlError, InputError) as error:
            sys.stderr.write(f"{name}: plan {number} cannot be read: {error}\n")
            continue
        verdict = validate(problem.domain, problem, plan, attachments=attachments)
        if verdict.valid:
            yield replace(plan, metric=verdict.metric)
        else:
            sys.stderr.write(f"{name}: plan {number} is not valid: {verdict.message}\n")
