"""Benchmarks: speed and quality, measured on request and never asserted in a test.

A topic is a module or package `scenarios.benchmarks.<topic>` that defines

    def run(*, quick: bool, out: Path) -> str

which measures, writes what it wants to keep into the folder `out`, and returns a table in
Markdown. Its first docstring line is its line in `marsupial bench`. A new topic is a new file
here; nothing else needs to know it.
"""

from __future__ import annotations

import ast
from importlib.util import find_spec
from pathlib import Path
from pkgutil import iter_modules


def topics() -> dict[str, str]:
    """Name and first docstring line of every topic, without importing any."""
    return {
        module.name: _first_line(f"{__name__}.{module.name}")
        for module in sorted(iter_modules(__path__), key=lambda module: module.name)
        if not module.name.startswith("_")
    }


def _first_line(name: str) -> str:
    found = find_spec(name)
    if found is None or found.origin is None:
        return ""
    tree = ast.parse(Path(found.origin).read_text(encoding="utf-8"))
    return (ast.get_docstring(tree) or "").partition("\n")[0]
