"""`marsupial format`: one layout for every PDDL file; comments stay."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from planner import _core
from planner.commands.faults import told
from planner.reading import InputError

UNFORMATTED = 1
"""Exit code of `--check` where a file would change, and of files too faulty to be formatted."""


def format_files(
    files: Annotated[list[Path], typer.Argument(help="PDDL files; `-` for stdin to stdout.")],
    check: Annotated[
        bool, typer.Option("--check", help="Change nothing; fail if a file would change.")
    ] = False,
) -> None:
    """Format PDDL files in place: only white space changes, comments stay.

    Exit codes: 0 done, 1 a file would change (--check) or is too faulty, 31 a file that cannot
    be read.
    """
    failed = False
    with told():
        for path in files:
            failed |= not _one(path, check)
    raise typer.Exit(UNFORMATTED if failed else 0)


def _one(path: Path, check: bool) -> bool:
    """Formats one file; whether all is well with it."""
    piped = str(path) == "-"
    try:
        content = sys.stdin.buffer.read() if piped else path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {str(path)!r}: {error.strerror or error}") from error
    name = "<stdin>" if piped else str(path)
    text, faults = _core.format_file((name, content))
    if text is None:
        sys.stderr.write("".join(f"{fault.rendered}\n" for fault in faults))
        sys.stderr.write(f"{name} is left as it is: mend its parentheses first\n")
        return False
    changed = text.encode() != content
    if check:
        if changed:
            sys.stdout.write(f"{name} would change\n")
        return not changed
    if piped:
        sys.stdout.write(text)
    elif changed:
        path.write_text(text, encoding="utf-8", newline="\n")
        sys.stdout.write(f"{name} formatted\n")
    return True
