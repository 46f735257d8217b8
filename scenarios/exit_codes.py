"""Exit codes of the `marsupial` command, in the planning field's decades.

0 done; 10-19 there is no solution; 20-29 a limit was hit; 30-39 faults; 130 interrupted.
"""

from __future__ import annotations

NO_SOLUTION = 12
"""the mission cannot be finished by this team"""
TIME_LIMIT = 23
FAULT = 30
INPUT_ERROR = 31
USAGE_ERROR = 36
"""a command line that cannot be understood"""
INTERRUPTED = 130


class CommandError(Exception):
    """Ends a command with one sentence for the user and an exit code."""

    def __init__(self, message: str, exit_code: int = INPUT_ERROR) -> None:
        super().__init__(message)
        self.exit_code = exit_code
