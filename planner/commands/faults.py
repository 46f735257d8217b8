"""Faults as a user of the command line sees them: sentences and an exit code, never a traceback."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from planner.diagnostics import PlannerError
from planner.outcome import Outcome


@contextmanager
def told() -> Iterator[None]:
    """Turns the planner's exceptions into text on stderr and the exit code of their outcome."""
    try:
        yield
    except PlannerError as error:
        sys.stderr.write(f"{error}\n".rstrip() + "\n")
        if error.__cause__ is not None:
            cause = error.__cause__
            sys.stderr.write(f"  because {type(cause).__name__}: {cause}\n")
        raise SystemExit(error.outcome.row.exit_code) from None
    except OSError as error:
        sys.stderr.write(f"cannot use {error.filename}: {error.strerror}\n")
        raise SystemExit(Outcome.INPUT_ERROR.row.exit_code) from None
