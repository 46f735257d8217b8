"""Every code can be explained, and the page of codes is up to date."""

from pathlib import Path

import pytest

from planner import _core
from planner.commands.explain import as_markdown, explanation, listing
from planner.reading import InputError

ROOT = Path(__file__).parents[3]


def test_the_page_equals_the_table() -> None:
    page = (ROOT / "docs" / "diagnostics.md").read_text(encoding="utf-8")
    assert page == as_markdown(), "run: marsupial explain --markdown > docs/diagnostics.md"


@pytest.mark.parametrize("code", [row[0] for row in _core.codes()])
def test_every_code_is_explained(code: str) -> None:
    text = explanation(code)
    assert text.startswith(f"{code}: ")
    assert explanation(code.lower()) == explanation(code.removeprefix("PDDL").lstrip("0")) == text
    assert code in listing()


def test_an_unknown_code_is_a_sentence() -> None:
    with pytest.raises(InputError, match="PDDL999"):
        explanation("PDDL999")
