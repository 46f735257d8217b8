"""Plain words make the same request as the command line library reads from them."""

import pytest
import typer
from typer.testing import CliRunner

from planner.commands import plan
from planner.commands.plan_run import PlanRequest
from planner.commands.plan_words import FLAGS, OPTIONS, plain_request

VALUES = {
    "timeout": "0",
    "cpu-timeout": "2.5",
    "plan-file": "out/PLAN",
    "map": "map.yaml",
    "seed": "7",
    "threads": "2",
    "node-limit": "1000",
    "memory-limit": "64",
    "json": "out.json",
    "svg": "out.svg",
    "html": "out.html",
    "engine": "tamer",
    "heuristic": "context-enhanced-additive",
    "space": "decision-epochs",
}
FILES = ["domain.pddl", "problem.pddl"]


@pytest.fixture
def requests(monkeypatch: pytest.MonkeyPatch) -> list[PlanRequest]:
    """What the command asks for, in place of planning."""
    made: list[PlanRequest] = []

    def keep(request: PlanRequest, _: object) -> int:
        made.append(request)
        return 0

    monkeypatch.setattr(plan, "run_plan", keep)
    return made


def typer_reads(words: list[str]) -> int:
    app = typer.Typer(add_completion=False)
    app.command()(plan.plan_command())
    return CliRunner().invoke(app, words).exit_code


@pytest.mark.parametrize(
    "words",
    [
        FILES,
        ["--first", *FILES],
        [FILES[0], "--watch", FILES[1], "--first", "--seed=3"],
        [*FILES, *(word for name, value in VALUES.items() for word in (f"--{name}", value))],
        [*FILES, *(f"--{name}={value}" for name, value in VALUES.items())],
    ],
    ids=" ".join,
)
def test_both_make_the_same_request(words: list[str], requests: list[PlanRequest]) -> None:
    assert typer_reads(words) == 0
    assert plain_request(words) == requests[0]


def test_every_option_is_known(requests: list[PlanRequest]) -> None:
    assert set(VALUES) == set(OPTIONS)
    for name, value in VALUES.items():
        assert typer_reads([*FILES, f"--{name}", value]) == 0
        assert plain_request([*FILES, f"--{name}", value]) == requests[-1], name
    for name in FLAGS:
        assert typer_reads([*FILES, f"--{name}"]) == 0
        assert plain_request([*FILES, f"--{name}"]) == requests[-1], name
    assert len({repr(request) for request in requests}) == len(OPTIONS) + len(FLAGS)


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["domain.pddl"],
        [*FILES, "plan"],
        [*FILES, "--help"],
        [*FILES, "-h"],
        [*FILES, "--nonsense"],
        [*FILES, "--seed"],
        [*FILES, "--seed", "many"],
        [*FILES, "--seed", "-1"],
        [*FILES, "--threads", "0"],
        [*FILES, "--timeout", "nan"],
        [*FILES, "--engine", "steam"],
        [*FILES, "--heuristic", "luck"],
        [*FILES, "--first=yes"],
        [*FILES, "--seed", "1", "--seed", "2"],
    ],
    ids=" ".join,
)
def test_anything_else_is_left_to_the_library(words: list[str]) -> None:
    assert plain_request(words) is None
