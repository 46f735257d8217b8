"""Every domain of the project is what `marsupial format` writes, and `marsupial check` finds
nothing in it and its problems.
"""

from pathlib import Path

import pytest

import domains
from planner import _core
from planner.commands.check import check_paths

ROOT = Path(domains.__file__).parent
FOLDERS = sorted(path.parent.name for path in ROOT.glob("*/domain.pddl"))


def test_every_domain_is_walked() -> None:
    assert domains.available() == FOLDERS


@pytest.mark.parametrize("folder", FOLDERS)
def test_the_domain_is_formatted(folder: str) -> None:
    path = ROOT / folder / "domain.pddl"
    formatted, findings = _core.format_file((str(path), path.read_bytes()))
    assert not findings
    assert formatted == path.read_text(encoding="utf-8"), f"run: marsupial format {path}"


@pytest.mark.parametrize("folder", FOLDERS)
def test_there_is_nothing_to_find(folder: str) -> None:
    problems = sorted((ROOT / folder / "problems").glob("*.pddl"))
    assert problems
    found = check_paths(ROOT / folder / "domain.pddl", problems)
    assert not found, "\n".join(one.rendered for one in found)
