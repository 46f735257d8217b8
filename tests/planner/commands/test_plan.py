"""`marsupial plan`, as a user runs it."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.planner.problems import WINDOW
from tests.planner.test_facade import COURIER, ERRANDS, hard_problem

ROOT = Path(__file__).parents[3]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A domain and a problem."""
    (tmp_path / "domain.pddl").write_text(WINDOW.domain)
    (tmp_path / "problem.pddl").write_text(WINDOW.problem)
    return tmp_path


def marsupial(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "scenarios.cli", *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "100"},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def test_the_best_plan_is_printed_and_can_be_validated(folder: Path) -> None:
    done = marsupial(folder, "plan", "domain.pddl", "problem.pddl", "--timeout", "2")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(";;!domain: window\n;;!problem: window-1\n")
    assert "plan 1: makespan" in done.stderr
    (folder / "plan").write_text(done.stdout)
    checked = marsupial(folder, "validate", "domain.pddl", "problem.pddl", "plan")
    assert checked.returncode == 0
    assert checked.stdout.startswith("Plan valid, makespan ")


def test_files_are_written(folder: Path) -> None:
    files = ("--json", "out.json", "--svg", "out.svg", "--html", "out.html", "--plan-file", "P")
    done = marsupial(
        folder, "plan", "domain.pddl", "problem.pddl", "--timeout", "2", "--seed", "5", *files
    )
    assert done.returncode == 0, done.stderr
    report = json.loads((folder / "out.json").read_text())
    assert {"outcome", "plans", "lower_bound", "expansions", "evaluations", "cpu_s"} <= set(report)
    assert {"peak_mb", "version", "seed"} <= set(report)
    assert (report["outcome"], report["seed"]) == ("solved_optimally", 5)
    assert set(report["plans"][0]) >= {"makespan", "cpu_s", "wall_s", "steps"}
    assert set(report["plans"][0]["steps"][0]) == {"start", "action", "args", "duration"}
    assert report["cpu_s"] >= report["plans"][-1]["cpu_s"] > 0
    assert report["peak_mb"] > 1
    written = sorted(folder.glob("P.*"))
    assert len(written) == len(report["plans"])
    assert (folder / f"P.{len(written)}").read_text() == done.stdout
    ElementTree.parse(folder / "out.svg")
    assert "<svg" in (folder / "out.html").read_text()


def plain_hard_problem(folder: Path) -> None:
    """The courier's long round with way times as fluents."""
    domain, problem = hard_problem()
    names = [word for word in problem.split() if word[:1] == "p" and word[1:].isdigit()]
    values = " ".join(
        f"(= (way {a} {b}) {abs(int(a[1:]) - int(b[1:])) + 1})" for a in names for b in names
    )
    domain = domain.replace(" (at start ([open ?b]))", "").replace("[wayTime ?a ?b]", "(way ?a ?b)")
    start, end = domain.index("(:modules"), domain.index("(:predicates")
    (folder / "domain.pddl").write_text(
        f"{domain[:start]}(:functions (way ?a ?b - place))\n{domain[end:]}"
    )
    (folder / "problem.pddl").write_text(problem.replace("(at p10)", f"(at p10) {values}"))


def test_a_limit_shows_in_the_exit_code(folder: Path) -> None:
    plain_hard_problem(folder)
    done = marsupial(
        folder, "plan", "domain.pddl", "problem.pddl", "--node-limit", "200", "--timeout", "0"
    )
    assert done.returncode in {0, 1, 24}, done.stderr
    if done.returncode == 1:
        assert done.stdout
    done = marsupial(folder, "plan", "domain.pddl", "problem.pddl", "--first")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("makespan") == 1
    done = marsupial(folder, "plan", "domain.pddl", "problem.pddl", "--seed", "-1")
    assert done.returncode == 36


def test_no_plan_is_said_and_coded(folder: Path) -> None:
    problem = WINDOW.problem.replace("(fragile c1)", "").replace(
        "(at 4 (open g))", "(at 9 (open g))"
    )
    (folder / "problem.pddl").write_text(problem)
    done = marsupial(folder, "plan", "domain.pddl", "problem.pddl", "--timeout", "5")
    assert done.returncode in {11, 12}, done.stderr
    assert "no plan: " in done.stderr
    assert done.stdout == ""


def test_faults_are_sentences(folder: Path) -> None:
    (folder / "bad.pddl").write_text(WINDOW.domain.replace(":effect (done)", ":effect (dome)"))
    done = marsupial(folder, "plan", "bad.pddl", "problem.pddl")
    assert done.returncode == 31
    assert "bad.pddl:" in done.stderr
    assert "did you mean `done`?" in done.stderr
    assert "Traceback" not in done.stderr
    done = marsupial(folder, "plan", "none.pddl", "problem.pddl")
    assert (done.returncode, done.stdout) == (31, "")
    assert "none.pddl" in done.stderr


def test_modules_without_map_are_asked_for(folder: Path) -> None:
    (folder / "domain.pddl").write_text(COURIER)
    (folder / "problem.pddl").write_text(ERRANDS)
    done = marsupial(folder, "plan", "domain.pddl", "problem.pddl")
    assert done.returncode == 31
    assert "--map" in done.stderr
    done = marsupial(folder, "plan", "domain.pddl", "problem.pddl", "--map", "no.yaml")
    assert done.returncode == 31
    assert "no.yaml" in done.stderr


def test_an_absent_peer_is_one_sentence(folder: Path) -> None:
    done = marsupial(folder, "plan", "domain.pddl", "problem.pddl", "--engine", "kairos")
    if done.returncode == 0:
        pytest.skip("kairos is installed")
    assert done.returncode == 34
    assert done.stderr == "the engine kairos is not installed: pip install kairos-planner\n"


def test_ctrl_c_gives_the_best_plan_so_far(folder: Path) -> None:
    plain_hard_problem(folder)
    process = subprocess.Popen(
        [sys.executable, "-m", "scenarios.cli", "plan", "domain.pddl", "problem.pddl"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    assert "plan 1: makespan" in process.stderr.readline()
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=20)
    assert process.returncode in {0, 3}, errors  # 0: proved optimal before the signal came
    assert "; Makespan: " in output
    assert "Traceback" not in errors
