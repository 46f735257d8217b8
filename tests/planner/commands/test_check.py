"""A domain with ten seeded faults is mended from the output of `marsupial check` alone."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer import Typer
from typer.testing import CliRunner, Result

import planner
from planner.commands.check import check

GOLDEN = Path(__file__).parents[2] / "golden" / "check"

MENDS = [
    # What the first run says: misspelt names, a parenthesis, a time, an argument, a flag.
    [
        ("(distnace ?from ?to)", "(distance ?from ?to)"),
        ("(over all (at ?r ?from))\n", "(over all (at ?r ?from)))\n"),
        (":effect (cleared ?b)", ":effect (at end (cleared ?b))"),
        ("(over all (at ?r))", "(over all (at ?r ?t))"),
        ("(explord ?t)", "(explored ?t)"),
        (":durative-actions)", ":durative-actions :numeric-fluents :duration-inequalities)"),
    ],
    # What the second says once the file can be read: the rest of them.
    [
        ("\n      (over all (at ?r ?from))", ""),
        (" ?b - blockade)\n    :duration (>= ?duration 5)", ")\n    :duration (= ?duration 5)"),
        (" :duration-inequalities", ""),
        (" (at start (charged ?r))", ""),
        ("\n    (charged ?r - robot)", ""),
    ],
]
"""(written, mended) in the order of the runs"""


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[..., Result]:
    """The command in an empty folder."""
    monkeypatch.chdir(tmp_path)
    app = Typer()
    app.command()(check)
    return lambda *words: CliRunner().invoke(app, list(words))


def copied(tmp_path: Path) -> tuple[Path, Path]:
    paths = tmp_path / "rescue.pddl", tmp_path / "rescue-problem.pddl"
    for path in paths:
        path.write_text((GOLDEN / path.name).read_text())
    return paths


def test_ten_faults_are_mended_from_the_transcript(
    run: Callable[..., Result], tmp_path: Path
) -> None:
    domain, _ = copied(tmp_path)
    transcript = ""
    for round_of_mends in [*MENDS, []]:
        result = run("rescue.pddl", "rescue-problem.pddl")
        transcript += "$ marsupial check rescue.pddl rescue-problem.pddl\n" + result.stdout
        text = domain.read_text()
        for written, mended in round_of_mends:
            assert text.count(written) == 1, written
            text = text.replace(written, mended)
        domain.write_text(text)
    assert result.exit_code == 0
    assert transcript == (GOLDEN / "transcript.txt").read_text()
    solved = planner.solve(domain, tmp_path / "rescue-problem.pddl", timeout_s=10)
    assert solved.plan is not None


def test_json_gives_places_remedies_and_edits(run: Callable[..., Result], tmp_path: Path) -> None:
    copied(tmp_path)
    result = run("rescue.pddl", "--json", "-")
    assert result.exit_code == 1
    findings = json.loads(result.stdout)
    misspelt = next(one for one in findings if one["code"] == "PDDL022")
    lines = (tmp_path / "rescue.pddl").read_text().splitlines()
    line, column = misspelt["line"], misspelt["column"]
    assert lines[line - 1][column - 1 :].startswith("distnace")
    assert misspelt["fix"]["edits"][0]["replacement"] == "distance"


def test_sarif_names_a_rule_for_every_result(run: Callable[..., Result], tmp_path: Path) -> None:
    copied(tmp_path)
    run("rescue.pddl", "--sarif", "log.sarif")
    log = json.loads((tmp_path / "log.sarif").read_text())
    assert log["version"] == "2.1.0"
    (single,) = log["runs"]
    rules = single["tool"]["driver"]["rules"]
    assert single["results"]
    for result in single["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        region = result["locations"][0]["physicalLocation"]["region"]
        assert (region["startLine"], region["startColumn"]) <= (
            region["endLine"],
            region["endColumn"],
        )


def test_warnings_fail_only_if_asked(run: Callable[..., Result], tmp_path: Path) -> None:
    (tmp_path / "d.pddl").write_text("(define (domain d) (:predicates (p)))")
    assert run("d.pddl").exit_code == 0
    assert run("d.pddl", "--strict").exit_code == 1


def test_an_absent_file_is_a_sentence(run: Callable[..., Result]) -> None:
    result = run("absent.pddl")
    assert result.exit_code == 31
    assert "absent.pddl" in result.output


def test_exchanged_files_are_recognised(run: Callable[..., Result], tmp_path: Path) -> None:
    copied(tmp_path)
    result = run("rescue-problem.pddl", "rescue.pddl")
    assert result.exit_code == 1
    assert "perhaps domain and problem are exchanged" in result.stdout
