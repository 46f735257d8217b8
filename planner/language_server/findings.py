"""Findings as diagnostics and code actions of the Language Server Protocol."""

from collections.abc import Iterable
from pathlib import Path

from lsprotocol import types

from planner import _core
from planner._core import Finding
from planner.language_server.documents import Document, Family

SEVERITIES = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "information": types.DiagnosticSeverity.Information,
}
UNUSED = {"PDDL080", "PDDL081", "PDDL082"}
"""Codes of things that an editor may show faded."""


def as_range(place: tuple[int, int, int, int]) -> types.Range:
    """A range of the protocol."""
    line, column, end_line, end_column = place
    return types.Range(types.Position(line, column), types.Position(end_line, end_column))


def findings(
    documents: Family, opened: Iterable[Path], providers: list[str] | None
) -> dict[Path, list[Finding]]:
    """Findings of a family's open documents; problems that are not open are not looked at."""
    shown = set(opened)
    problems = [one for one in documents.problems if one.path in shown]
    if documents.domain is None:
        return {one.path: _core.format_file(_file(one))[1] for one in problems}
    found = _core.check_files(_file(documents.domain), [_file(one) for one in problems], providers)
    by_path = dict(
        zip([documents.domain.path, *(one.path for one in problems)], found, strict=True)
    )
    return {path: list(found) for path, found in by_path.items() if path in shown}


def _file(document: Document) -> tuple[str, bytes]:
    return str(document.path), document.text.encode("utf-8", errors="replace")


def as_diagnostic(one: Finding) -> types.Diagnostic:
    """A diagnostic of the protocol."""
    message = one.message if not one.label else f"{one.message}: {one.label}"
    if one.remedy is not None:
        message += f"\n{one.remedy}"
    return types.Diagnostic(
        range=as_range(one.range),
        message=message,
        severity=SEVERITIES[one.severity],
        code=one.code,
        source="marsupial",
        tags=[types.DiagnosticTag.Unnecessary] if one.code in UNUSED else None,
        related_information=[
            types.DiagnosticRelatedInformation(
                types.Location(Path(file).absolute().as_uri(), as_range(place)), text
            )
            for file, place, text in one.notes
        ],
    )


def missing_domain(documents: Family) -> list[types.Diagnostic]:
    """Says of a problem that its domain was not found, so that silence is not taken for praise."""
    definition = documents.problems[0].definition if documents.problems else None
    if documents.domain is not None or definition is None:
        return []
    message = (
        f"domain `{definition[2] or '?'}` was not found beside this problem: "
        "only parentheses are checked"
    )
    return [
        types.Diagnostic(
            range=as_range((0, 0, 0, 1)),
            message=message,
            severity=types.DiagnosticSeverity.Information,
            source="marsupial",
        )
    ]


def as_action(one: Finding, uri: str) -> types.CodeAction | None:
    """The fix of a finding, if it has one."""
    if one.fix is None:
        return None
    title, edits = one.fix
    changes = [types.TextEdit(as_range(place), replacement) for place, replacement in edits]
    return types.CodeAction(
        title=title,
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[as_diagnostic(one)],
        edit=types.WorkspaceEdit(changes={uri: changes}),
        is_preferred=True,
    )
