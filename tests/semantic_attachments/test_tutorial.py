"""The tutorial docs/attachments.md: its Python runs as it stands."""

import re
from pathlib import Path
from typing import Any

import pytest

TUTORIAL = Path(__file__).parents[2] / "docs" / "attachments.md"


def test_the_code_of_the_tutorial_runs(capsys: pytest.CaptureFixture[str]) -> None:
    text = TUTORIAL.read_text(encoding="utf-8")
    blocks = list(re.finditer(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE))
    assert len(blocks) >= 8
    names: dict[str, Any] = {"__name__": "tutorial"}
    for block in blocks:
        # Line numbers of errors are those of the page.
        before = text[: block.start(1)].count("\n")
        code = compile("\n" * before + block[1], str(TUTORIAL), "exec")
        exec(code, names)
    shown = capsys.readouterr().out
    assert "(fly scout dock yard) [16" in shown
    assert "flycost scout" in shown.lower()
