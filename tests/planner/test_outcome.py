"""The table of outcomes."""

import re
from pathlib import Path

from planner import OUTCOMES, Outcome
from planner.diagnostics import AttachmentError, InternalError, PddlError
from planner.solving import UnsupportedError

DECADES = {0: range(0, 1), 1: range(1, 4), 2: range(10, 13), 3: range(20, 25), 4: range(30, 38)}


def test_every_outcome_has_a_row_and_a_code_of_its_own() -> None:
    assert set(OUTCOMES) == set(Outcome)
    allowed = {code for decade in DECADES.values() for code in decade}
    codes = [row.exit_code for row in OUTCOMES.values()]
    assert set(codes) <= allowed
    assert codes.count(0) == 2
    assert len(set(codes)) == len(codes) - 1


def test_solved_means_a_plan() -> None:
    assert {one for one in Outcome if one.solved} == {
        Outcome.SOLVED_OPTIMALLY,
        Outcome.SOLVED,
        Outcome.SOLVED_OUT_OF_MEMORY,
        Outcome.SOLVED_TIMED_OUT,
        Outcome.SOLVED_CANCELLED,
    }


def test_faults_have_outcomes() -> None:
    faults = (InternalError, PddlError, AttachmentError, UnsupportedError)
    assert [fault.outcome.row.exit_code for fault in faults] == [30, 31, 33, 34]


def test_the_documentation_has_the_same_table() -> None:
    text = (Path(__file__).parents[2] / "docs" / "outcomes.md").read_text()
    rows = re.findall(r"^\| `(\w+)` \| (\d+) \| (\d+) \| (.+) \|$", text, re.MULTILINE)
    assert rows == [
        (one.value, str(row.exit_code), str(row.http_status), row.meaning)
        for one, row in OUTCOMES.items()
    ]
