"""Findings as SARIF 2.1.0, which code hosts show beside the lines concerned.

Source: OASIS, "Static Analysis Results Interchange Format (SARIF) Version 2.1.0", 2020.
"""

from collections.abc import Iterable
from pathlib import PurePath
from typing import Any

from planner import _core
from planner._core import Finding

LEVELS = {"error": "error", "warning": "warning", "information": "note"}


def as_sarif(findings: Iterable[Finding]) -> dict[str, Any]:
    """A SARIF log with one run; its rules are all diagnostic codes."""
    codes = _core.codes()
    index = {code: position for position, (code, *_) in enumerate(codes)}
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [
            {
                "tool": {
                    "driver": {
                        "name": "marsupial",
                        "version": _core.__version__,
                        "rules": [_rule(row) for row in codes],
                    }
                },
                "columnKind": "utf16CodeUnits",
                "results": [_result(one, index[one.code]) for one in findings],
            }
        ],
    }


def _rule(row: tuple[str, str, str, str, str, str]) -> dict[str, Any]:
    code, severity, title, what, why, example = row
    return {
        "id": code,
        "shortDescription": {"text": title},
        "fullDescription": {"text": what},
        "help": {"text": f"{why}\n\nExample:\n{example}"},
        "defaultConfiguration": {"level": LEVELS[severity]},
    }


def _result(one: Finding, rule: int) -> dict[str, Any]:
    text = one.message if one.remedy is None else f"{one.message}; {one.remedy}"
    result: dict[str, Any] = {
        "ruleId": one.code,
        "ruleIndex": rule,
        "level": LEVELS[one.severity],
        "message": {"text": text},
        "locations": [_location(one.file, one.range)],
        "relatedLocations": [
            {**_location(file, place), "message": {"text": note}} for file, place, note in one.notes
        ],
    }
    if one.fix is not None:
        title, edits = one.fix
        replacements = [
            {"deletedRegion": _region(place), "insertedContent": {"text": text}}
            for place, text in edits
        ]
        change = {"artifactLocation": _artifact(one.file), "replacements": replacements}
        result["fixes"] = [{"description": {"text": title}, "artifactChanges": [change]}]
    return result


def _location(file: str, place: tuple[int, int, int, int]) -> dict[str, Any]:
    return {"physicalLocation": {"artifactLocation": _artifact(file), "region": _region(place)}}


def _artifact(file: str) -> dict[str, str]:
    return {"uri": PurePath(file).as_posix()}


def _region(place: tuple[int, int, int, int]) -> dict[str, int]:
    line, column, end_line, end_column = place
    return {
        "startLine": line + 1,
        "startColumn": column + 1,
        "endLine": end_line + 1,
        "endColumn": end_column + 1,
    }
