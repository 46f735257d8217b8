"""`marsupial check`: what is wrong with a domain and its problems, where, and how to mend it."""

import json
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from planner import _core
from planner._core import Finding
from planner.commands.faults import told
from planner.commands.sarif import as_sarif
from planner.language_server.providers import providers_for
from planner.reading import InputError

FAULTY = 1
"""Exit code where an error was found."""


def check(
    domain: Annotated[Path, typer.Argument(help="PDDL domain file.")],
    problems: Annotated[
        list[Path] | None, typer.Argument(help="PDDL problem files of that domain.")
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Warnings fail as errors do.")] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the findings as JSON; `-` for stdout.")
    ] = None,
    sarif_file: Annotated[
        Path | None, typer.Option("--sarif", help="Write them as SARIF 2.1.0; `-` for stdout.")
    ] = None,
) -> None:
    """Check a domain and problems: all faults in one run, each with its place and a remedy.

    `marsupial explain CODE` says more about a code. Exit codes: 0 no error, 1 errors (with
    --strict also warnings), 31 a file that cannot be read.
    """
    with told():
        findings = check_paths(domain, problems or [])
    quiet = False
    for path, document in ((json_file, as_json(findings)), (sarif_file, as_sarif(findings))):
        if path is not None:
            quiet |= _write(path, document)
    if not quiet:
        sys.stdout.write(as_text(findings, files=1 + len(problems or [])))
    bad = {"error", "warning"} if strict else {"error"}
    raise typer.Exit(FAULTY if any(one.severity in bad for one in findings) else 0)


def check_paths(domain: Path, problems: Sequence[Path]) -> list[Finding]:
    """Findings in the domain, then in each problem; raises `InputError` for an unreadable file."""
    files = [_read(path) for path in (domain, *problems)]
    providers = providers_for(files[0][1])
    if providers.fault is not None:
        sys.stderr.write(f"{providers.fault}: modules without provider are not looked for\n")
    found = _core.check_files(files[0], files[1:], providers.names)
    return [one for findings in found for one in findings]


def _read(path: Path) -> tuple[str, bytes]:
    try:
        return str(path), path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {str(path)!r}: {error.strerror or error}") from error


def _write(path: Path, document: Any) -> bool:
    """Writes JSON; true if it went to the standard output."""
    text = json.dumps(document, indent=1) + "\n"
    if str(path) == "-":
        sys.stdout.write(text)
        return True
    path.write_text(text, encoding="utf-8")
    return False


def as_text(findings: Iterable[Finding], files: int) -> str:
    """The findings with the lines concerned and carets, and a closing sentence."""
    shown = list(findings)
    counts = {
        severity: sum(one.severity == severity for one in shown)
        for severity in ("error", "warning", "information")
    }
    parts = [_counted(count, word) for word, count in counts.items() if count]
    where = _counted(files, "file")
    closing = f"{', '.join(parts) or 'no findings'} in {where}\n"
    return "".join(f"{one.rendered}\n" for one in shown) + closing


def _counted(count: int, word: str) -> str:
    return f"{count} {word}" + ("s" if count != 1 and word != "information" else "")


def as_json(findings: Iterable[Finding]) -> list[dict[str, Any]]:
    """The findings; lines and columns count from 1, columns are UTF-16 code units."""
    return [
        {
            "code": one.code,
            "severity": one.severity,
            "message": one.message,
            "label": one.label,
            "file": one.file,
            **_place(one.range),
            "notes": [
                {"file": file, **_place(place), "text": text} for file, place, text in one.notes
            ],
            "remedy": one.remedy,
            "fix": None
            if one.fix is None
            else {
                "title": one.fix[0],
                "edits": [{**_place(place), "replacement": text} for place, text in one.fix[1]],
            },
        }
        for one in findings
    ]


def _place(place: tuple[int, int, int, int]) -> dict[str, int]:
    line, column, end_line, end_column = place
    return {
        "line": line + 1,
        "column": column + 1,
        "end_line": end_line + 1,
        "end_column": end_column + 1,
    }
