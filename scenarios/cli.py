"""The `marsupial` command: what is common to all of its commands.

`plan` with plain words runs without the command line library, whose import takes longer than a
first plan to find; all else is the application's.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from scenarios.exit_codes import FAULT, INPUT_ERROR, INTERRUPTED, CommandError


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line; a user sees sentences, never a traceback."""
    # No command multiplies large matrices, and starting BLAS threads takes more CPU than reading
    # a map and a problem.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    words = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
    try:
        stranger = someone_elses_room()
        if stranger is not None:
            raise CommandError(stranger, FAULT)
        sys.exit(run(words))
    except CommandError as failure:
        _say(str(failure))
        sys.exit(failure.exit_code)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(128 + signal.SIGPIPE)
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        _say(f"{error.filename}: {error.strerror}; check the path")
        sys.exit(INPUT_ERROR)
    except Exception as fault:
        if "--debug" in words:
            raise
        _say(
            f"this should not have happened: {type(fault).__name__}: {fault}\n"
            "`marsupial --debug ...` shows where; please report it with that output."
        )
        sys.exit(FAULT)


def someone_elses_room() -> str | None:
    """What is wrong if another distribution's package of the same name comes first on the path."""
    home = Path(__file__).resolve().parent.parent
    for room in ("planner", "semantic_attachments", "domains", "service", "simulator"):
        found = find_spec(room)
        if found is None or found.origin is None:
            return f"marsupial's package {room!r} is missing: install it again"
        if Path(found.origin).resolve().parent.parent != home:
            return (
                f"the package {room!r} at {found.origin} is not marsupial's: "
                "install marsupial into a virtual environment of its own"
            )
    return None


def run(words: Sequence[str]) -> Any:
    """Runs a command; its exit code."""
    if words[0] == "plan":
        from planner.commands.plan_words import plain_request

        request = plain_request(words[1:])
        if request is not None:
            from planner.commands.plan_run import run_plan
            from scenarios.map_attachments import map_attachments

            return run_plan(request, map_attachments)
    from scenarios.application import run_application

    return run_application(words)


def _say(message: str) -> None:
    sys.stderr.write(f"marsupial: {message}\n")


if __name__ == "__main__":
    main()
