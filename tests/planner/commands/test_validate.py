"""`marsupial validate`, as a user runs it."""

import json
from pathlib import Path

import pytest

from tests.planner.commands.test_plan import marsupial
from tests.planner.problems import MATCH_CELLAR


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A domain, a problem and a plan."""
    (tmp_path / "domain.pddl").write_text(MATCH_CELLAR.domain)
    (tmp_path / "problem.pddl").write_text(MATCH_CELLAR.problem)
    (tmp_path / "plan").write_text(MATCH_CELLAR.plan)
    return tmp_path


def test_a_valid_plan_with_its_report(folder: Path) -> None:
    done = marsupial(folder, "validate", "domain.pddl", "problem.pddl", "plan", "-v")
    assert done.returncode == 0, done.stderr
    assert "  over all of (mend_fuse f1 m1): (light m1) holds" in done.stdout
    assert done.stdout.endswith("Plan valid, makespan 8.000\nMetric: 8\n")


def test_an_invalid_plan_names_happening_action_condition_and_facts(folder: Path) -> None:
    (folder / "plan").write_text(MATCH_CELLAR.plan.replace("3.002:", "5.000:"))
    done = marsupial(folder, "validate", "domain.pddl", "problem.pddl", "plan", "--json", "v.json")
    assert done.returncode == 1
    assert done.stdout == (
        "Plan invalid\n"
        "happening 5, time 8: (mend_fuse f2 m1) (step 3): "
        "its condition over all (light m1) does not hold\n"
        "  (light m1) is false since 8 (end of (light_match m1))\n"
    )
    verdict = json.loads((folder / "v.json").read_text())
    assert (verdict["valid"], verdict["reason"], verdict["step"]) == (False, "condition", 2)


def test_the_tolerance_counts(folder: Path) -> None:
    (folder / "plan").write_text(MATCH_CELLAR.plan.replace("[4.000]", "[4.005]"))
    words = ("validate", "domain.pddl", "problem.pddl", "plan")
    assert marsupial(folder, *words).returncode == 1
    assert marsupial(folder, *words, "-t", "0.008").returncode == 0


def test_a_plan_that_cannot_be_read_shows_where(folder: Path) -> None:
    (folder / "plan").write_text("0: (light_match m1) [8]\n1: (mend_fuse f1) [3]\n")
    done = marsupial(folder, "validate", "domain.pddl", "problem.pddl", "plan")
    assert done.returncode == 31
    assert "plan:2:4" in done.stderr
    assert "(mend_fuse ?f ?m)" in done.stderr
