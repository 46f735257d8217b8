"""The planner's benchmark: what it runs, how it scores, what it shows."""

from __future__ import annotations

from pathlib import Path

import pytest

from planner.compile_attachments import compile_attachments
from scenarios.benchmarks import planner as planner_benchmark
from scenarios.benchmarks.planner import rates
from scenarios.benchmarks.planner.contest import Run, run_engine
from scenarios.benchmarks.planner.instances import Instance, families, ipc_instances
from scenarios.benchmarks.planner.report import losses, markdown, sat_scores
from scenarios.exit_codes import CommandError

DOMAIN = """(define (domain hop) (:requirements :durative-actions)
 (:predicates (here) (there))
 (:durative-action hop :parameters () :duration (= ?duration 3)
  :condition (at start (here)) :effect (and (at start (not (here))) (at end (there)))))"""
PROBLEM = "(define (problem p) (:domain hop) (:init (here)) (:goal (there)))"


def _run(instance: str, engine: str, *values: float) -> Run:
    plans = tuple((0.1 * index, value) for index, value in enumerate(values))
    return Run(instance, "2011 hops", engine, "solved", plans)


def test_sat_score_is_the_best_value_over_the_own() -> None:
    runs = [_run("a", "marsupial", 20, 10), _run("a", "kairos", 8), _run("b", "marsupial", 5)]
    runs.append(_run("b", "kairos"))
    scores = sat_scores(runs)
    assert scores["a", "marsupial"] == pytest.approx(0.8)
    assert scores["a", "kairos"] == 1.0
    assert scores["b", "marsupial"] == 1.0
    assert scores["b", "kairos"] == 0.0


def test_losses_are_shown() -> None:
    runs = [_run("a", "marsupial", 10), _run("a", "kairos", 8)]
    assert "| a | 10.00 | solved | kairos | 8.00 |" in losses(runs)
    text = markdown(runs, ("marsupial", "kairos"), 5)
    assert "| 2011 hops | 1 | 1 / 0.80 | 1 / 1.00 |" in text
    assert losses([_run("a", "marsupial", 8), _run("a", "kairos", 8)]).startswith("No peer")


def test_an_engine_runs_in_a_process_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "domain.pddl").write_text(DOMAIN)
    (tmp_path / "problem.pddl").write_text(PROBLEM)
    instance = Instance("hops", "hop", tmp_path / "domain.pddl", tmp_path / "problem.pddl")
    run = run_engine("marsupial", instance, 5.0)
    assert run.best == 3.0
    assert run.outcome == "solved_optimally"
    assert run.peak_mb > 1
    assert Run.from_json(run.as_json()) == run


def test_instances_are_found_in_order(tmp_path: Path) -> None:
    assert families(tmp_path) == []
    home = tmp_path / "ipc-2011" / "domains" / "hops-temporal-satisficing-strips"
    (home / "instances").mkdir(parents=True)
    (home / "domains").mkdir()
    for number in (10, 2):
        (home / "instances" / f"instance-{number}.pddl").touch()
    (home / "domains" / "domain-2.pddl").touch()
    found = ipc_instances(tmp_path)
    assert [one.name for one in found] == ["2011 hops 2", "2011 hops 10"]
    assert [one.domain.name for one in found] == ["domain-2.pddl", "domain.pddl"]


def test_rates_are_told_of_spaces_that_are_large_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rates, "FEWEST", 200)
    problem, attachments = rates.generated(rates.Size("floor", 3, 2, 12, 6), seed=1)
    plain = compile_attachments(problem, attachments).read()
    with_modules = rates.expansion_rate(problem, attachments, 6_000)
    with_fluents = rates.expansion_rate(plain, None, 6_000)
    assert with_modules is not None
    assert with_modules > 0
    assert with_fluents is not None
    assert with_fluents > 0
    small, costs = rates.generated(rates.Size("room", 1, 1, 1, 1), seed=1)
    assert rates.expansion_rate(small, costs, 6_000) is None


def test_a_family_that_is_not_there_is_refused_with_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(CommandError, match=r"nonsense.*held-out, large-team"):
        planner_benchmark.run(quick=True, out=tmp_path, domains=("held-out", "nonsense"))
    assert not list(tmp_path.iterdir())
