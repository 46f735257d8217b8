"""The commands and programs that the README and the scenarios' page show do run.

Tested are fenced `sh` blocks that call `marsupial` and fenced `python` blocks that begin with an
import (others are fragments). They run in a scratch folder that sees the repository's folders. A
block under a line `<!-- not tested: why -->` is left out; whole missions are slow tests.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "docs" / "scenarios.md"]
"""Other pages are tutorials whose blocks build on one another; their rooms test them."""
BLOCK = re.compile(
    r"(<!-- not tested: [^\n]+ -->\n+)?^```(sh|python)\n(.*?)^```", re.DOTALL | re.MULTILINE
)
WHOLE_MISSIONS = re.compile(r"^\s*marsupial (run|demo|bench)\b", re.MULTILINE)


def is_program(language: str, text: str) -> bool:
    if language == "python":
        return text.lstrip().startswith(("import ", "from "))
    return re.search(r"^\s*(marsupial|python -m scenarios\S*) ", text, re.MULTILINE) is not None


def blocks() -> list[object]:
    found: list[object] = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8") if page.is_file() else ""
        for number, match in enumerate(BLOCK.finditer(text), start=1):
            left_out, language, program = match.groups()
            if left_out is None and is_program(language, program):
                marks = [pytest.mark.slow] if WHOLE_MISSIONS.search(program) else []
                name = f"{page.name}-{number}"
                found.append(pytest.param(language, program, id=name, marks=marks))
    return found


def test_readme_shows_commands_and_a_program() -> None:
    shown = BLOCK.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    tested = {language for _, language, text in shown if is_program(language, text)}
    assert tested == {"sh", "python"}


@pytest.mark.parametrize(("language", "program"), blocks())
def test_snippet_runs(language: str, program: str, tmp_path: Path) -> None:
    for entry in ROOT.iterdir():
        if not entry.name.startswith((".", "out", "target", "build")):
            (tmp_path / entry.name).symlink_to(entry)
    commands = tmp_path / ".venv" / "bin"
    commands.mkdir(parents=True)
    for name, options in (("marsupial", "-m scenarios.cli"), ("python", "")):
        script = commands / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" {options} "$@"\n')
        script.chmod(0o755)
    (commands / "activate").write_text(f'PATH="{commands}:$PATH"\n', encoding="utf-8")
    words = ["sh", "-eu", "-c", f". .venv/bin/activate\n{program}"]
    if language == "python":
        words = [sys.executable, "-c", program]
    run = subprocess.run(
        words,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )
    assert run.returncode == 0, f"{program}\n{run.stdout}\n{run.stderr}"
