"""The commands and snippets that README and docs show do run.

A fenced `sh` or `python` block under a line `<!-- tested -->` is executed in a scratch folder that
sees the repository's folders; `<!-- tested: slow -->` keeps it for the slow tests.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(
    r"<!-- tested(: slow)? -->\n+```(sh|python)\n(.*?)^```", re.DOTALL | re.MULTILINE
)


def blocks() -> list[object]:
    found: list[object] = []
    for page in PAGES:
        if not page.is_file():
            continue
        for number, match in enumerate(BLOCK.finditer(page.read_text(encoding="utf-8")), start=1):
            slow, language, text = match.groups()
            marks = [pytest.mark.slow] if slow else []
            found.append(pytest.param(language, text, id=f"{page.name}-{number}", marks=marks))
    return found


@pytest.mark.parametrize(("language", "text"), blocks())
def test_snippet_runs(language: str, text: str, tmp_path: Path) -> None:
    for entry in ROOT.iterdir():
        if not entry.name.startswith((".", "out", "target", "build")):
            (tmp_path / entry.name).symlink_to(entry)
    command = tmp_path / ".commands" / "marsupial"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m scenarios.cli "$@"\n')
    command.chmod(0o755)
    path = os.pathsep.join(
        [str(command.parent), str(Path(sys.executable).parent), os.environ["PATH"]]
    )
    run = subprocess.run(
        ["sh", "-eu", "-c", text] if language == "sh" else [sys.executable, "-c", text],
        cwd=tmp_path,
        env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )
    assert run.returncode == 0, f"{text}\n{run.stdout}\n{run.stderr}"
