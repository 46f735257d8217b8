"""Solving and validating through the façade: inputs, attachments, faults, interrupts."""

import _thread
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

import planner
from planner import Outcome
from tests.planner.problems import EXAMPLES, MATCH_CELLAR, WINDOW, Example

COURIER = """(define (domain courier)
  (:requirements :typing :durative-actions :numeric-fluents)
  (:types place - object)
  (:modules (wayTime ?a ?b - place cost wayTime@roads)
            (open ?p - place conditionchecker open@roads))
  (:predicates (at ?p - place) (seen ?p - place))
  (:durative-action go :parameters (?a ?b - place)
   :duration (= ?duration [wayTime ?a ?b])
   :condition (and (at start (at ?a)) (at start ([open ?b])))
   :effect (and (at start (not (at ?a))) (at end (at ?b)) (at end (seen ?b)))))
"""
ERRANDS = """(define (problem errands) (:domain courier) (:objects p0 p1 p2 p9 - place)
  (:init (at p0)) (:goal (and (seen p1) (seen p2))))
"""


def way_time(a: str, b: str) -> float:
    """Places lie on a line; p9 cannot be reached."""
    return float("inf") if "p9" in (a, b) else 2.0 * abs(int(a[1:]) - int(b[1:])) + 1.0


def is_open(place: str) -> bool:
    return place != "p9"


class Batch:
    """An attachment that answers in batches and counts them."""

    def __init__(self) -> None:
        self.batches = 0
        self.calls = 0

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        self.batches += 1
        self.calls += len(calls)
        return [way_time(*call) for call in calls]


def hard_problem() -> tuple[str, str]:
    """Far more work than any test waits for."""
    places = [f"p{index}" for index in range(10, 70)]
    goal = " ".join(f"(seen {place})" for place in places[1:])
    problem = f"""(define (problem many) (:domain courier) (:objects {" ".join(places)} - place)
      (:init (at p10)) (:goal (and {goal})))"""
    return COURIER, problem


EASY = {"waytime": way_time, "open": is_open}


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_plans_are_found_improve_and_pass_the_validator(example: Example) -> None:
    result = planner.solve(example.domain, example.problem, timeout_s=2, node_limit=5000)
    assert result.outcome.solved
    assert result.plan is not None
    for plan in result.plans:
        verdict = planner.validate(
            example.domain, example.problem, plan, tolerance_s=1e-6, separation_s=0.001
        )
        assert verdict, verdict.message
    makespans = [plan.makespan for plan in result.plans]
    assert makespans == sorted(makespans, reverse=True)
    assert result.lower_bound <= result.plan.makespan
    gap = result.gap
    assert gap is not None
    assert 0 <= gap <= 1


def test_paths_texts_and_parsed_objects_are_the_same(tmp_path: Path) -> None:
    (tmp_path / "d.pddl").write_text(MATCH_CELLAR.domain)
    (tmp_path / "p.pddl").write_text(MATCH_CELLAR.problem)
    (tmp_path / "plan").write_text(MATCH_CELLAR.plan)
    domain = planner.read_domain(MATCH_CELLAR.domain)
    problem = planner.read_problem(domain, MATCH_CELLAR.problem)
    verdicts = {
        planner.validate(tmp_path / "d.pddl", tmp_path / "p.pddl", tmp_path / "plan"),
        planner.validate(str(tmp_path / "d.pddl"), str(tmp_path / "p.pddl"), MATCH_CELLAR.plan),
        planner.validate(domain, problem, planner.read_plan(problem, MATCH_CELLAR.plan)),
    }
    assert len(verdicts) == 1
    assert all(verdicts)


def test_a_problem_shows_what_is_in_it() -> None:
    problem = planner.read_problem(WINDOW.domain, WINDOW.problem)
    assert problem.name == "window-1"
    assert problem.domain.actions == ["push", "lift", "drop", "report"]
    assert problem.objects == {"g": ["gate"], "c1": ["crate"], "c2": ["crate"], "c3": ["crate"]}
    assert problem.facts == {("fragile", "c1"), ("fragile", "c3")}
    cellar = planner.read_problem(MATCH_CELLAR.domain, MATCH_CELLAR.problem)
    assert cellar.fluents[("mending", "f2")] == 4
    module = planner.read_domain(COURIER).modules[0]
    assert (module.kind, module.parameters) == ("cost", [("?a", ["place"]), ("?b", ["place"])])


def test_every_fault_of_a_domain_is_told_with_its_place() -> None:
    text = "(define (domain d) (:predicates (p ?x))\n (:action a :parameters () :effect (q)))"
    with pytest.raises(planner.PddlError) as caught:
        planner.read_domain(text, name="mine.pddl")
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.file, diagnostic.line, diagnostic.column) == ("mine.pddl", 2, 37)
    assert diagnostic.code == "PDDL021"
    assert "mine.pddl:2:37" in str(caught.value)
    assert "^" in str(caught.value)
    with pytest.raises(planner.PlannerError, match="No such file"):
        planner.read_domain("nowhere/domain.pddl")


def test_attachments_as_callables_and_in_batches() -> None:
    batch = Batch()
    single = planner.solve(COURIER, ERRANDS, attachments=EASY)
    batched = planner.solve(COURIER, ERRANDS, attachments={"WAYTIME": batch, "open": is_open})
    assert single.outcome is batched.outcome is Outcome.SOLVED_OPTIMALLY
    assert single.plan == batched.plan
    assert single.plan is not None
    assert single.plan.makespan == pytest.approx(6, abs=0.01)
    assert batch.batches < batch.calls


def test_an_attachment_that_raises_stops_planning() -> None:
    def lost(_a: str, _b: str) -> float:
        raise LookupError("no map")

    for attachments in ({"waytime": lost, "open": is_open}, {"open": is_open}):
        with pytest.raises(planner.AttachmentError) as caught:
            planner.solve(COURIER, ERRANDS, attachments=attachments)
        assert caught.value.module == "waytime"
        assert isinstance(caught.value.__cause__, LookupError) is ("waytime" in attachments)
    with pytest.raises(planner.AttachmentError, match="no map"):
        planner.validate(
            COURIER, ERRANDS, "0: (go p0 p1) [3]", attachments={"waytime": lost, "open": is_open}
        )


@pytest.mark.parametrize("value", [float("nan"), -1.0, "far", None, 1j])
def test_an_attachment_that_gives_no_cost_stops_planning(value: object) -> None:
    with pytest.raises(planner.AttachmentError):
        planner.solve(COURIER, ERRANDS, attachments={"waytime": lambda *_: value, "open": is_open})


class Level:
    """A condition on the state, and an effect on it."""

    purity = "state"

    def __call__(self, state: planner.State) -> bool:
        self.kept = state
        value = state.value("level")
        return value is not None and value >= 2 and not state.holds("done")


FILL = """(define (domain fill) (:requirements :numeric-fluents)
  (:modules (high conditionchecker high@x) (pour (level) effect pour@x))
  (:predicates (done)) (:functions (level))
  (:action pour :parameters () :effect ([pour]))
  (:action finish :parameters () :precondition ([high]) :effect (done)))"""
FULL = "(define (problem full) (:domain fill) (:init (= (level) 0)) (:goal (done)))"


def pour(state: planner.State) -> list[float]:
    return [(state.value("level") or 0) + 1]


def test_attachments_see_the_state_while_they_are_called() -> None:
    level = Level()
    attachments = {"high": level, "pour": pour}
    verdict = planner.validate(FILL, FULL, "(pour) (pour) (finish)", attachments=attachments)
    assert verdict.valid
    assert not planner.validate(FILL, FULL, "(pour) (finish)", attachments=attachments)
    with pytest.raises(RuntimeError, match="only while"):
        level.kept.value("level")


def test_the_search_sees_the_state_too() -> None:
    result = planner.solve(FILL, FULL, attachments={"high": Level(), "pour": pour})
    assert result.plan is not None
    assert [step.action for step in result.plan] == ["pour", "pour", "finish"]


def test_anytime_yields_improving_plans_and_returns_the_result() -> None:
    search = planner.solve_anytime(*hard_problem(), attachments=EASY, timeout_s=0.5)
    plans = []
    while True:
        try:
            plans.append(next(search))
        except StopIteration as end:
            result = end.value
            break
    assert result.plans == tuple(plans)
    assert result.outcome in {Outcome.SOLVED_TIMED_OUT, Outcome.SOLVED_OPTIMALLY}


def test_closing_the_iterator_stops_the_search() -> None:
    search = planner.solve_anytime(*hard_problem(), attachments=EASY, timeout_s=None)
    assert next(search).makespan > 0
    search.close()
    with pytest.raises(StopIteration):
        next(search)
    assert not search.gi_running


def test_ctrl_c_interrupts() -> None:
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        planner.solve(*hard_problem(), attachments=EASY, timeout_s=60)
    timer.join()


def test_other_threads_run_while_searching() -> None:
    ticks = 0
    stop = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not stop.wait(0.005):
            ticks += 1

    thread = threading.Thread(target=tick)
    thread.start()
    planner.solve(*hard_problem(), attachments=EASY, timeout_s=0.5)
    stop.set()
    thread.join()
    assert ticks > 5


def test_the_same_input_gives_the_same_plans() -> None:
    runs = [
        planner.solve(*hard_problem(), attachments=EASY, node_limit=300, timeout_s=None, seed=3)
        for _ in range(2)
    ]
    assert runs[0].plans == runs[1].plans
    assert runs[0].statistics.expansions == runs[1].statistics.expansions


def test_the_limit_that_ended_the_search_shows_in_the_outcome() -> None:
    def outcome(**limits: Any) -> Outcome:
        return planner.solve(*hard_problem(), attachments=EASY, **limits).outcome

    closed = WINDOW.problem.replace("(fragile c1)", "").replace("4 (open g)", "9 (open g)")
    nothing = planner.solve(WINDOW.domain, closed, node_limit=10, timeout_s=600.0)
    assert nothing.outcome is Outcome.OUT_OF_NODES
    assert outcome(node_limit=2000, timeout_s=600.0) is Outcome.SOLVED_OUT_OF_MEMORY
    # The clock alone does not make it the time limit: the nodes ran out long before.
    assert outcome(node_limit=2000, timeout_s=None) is Outcome.SOLVED_OUT_OF_MEMORY
    assert outcome(timeout_s=0.3) is Outcome.SOLVED_TIMED_OUT
    assert outcome(first_plan_only=True) is Outcome.SOLVED


def test_a_problem_without_plan_is_an_outcome() -> None:
    problem = ERRANDS.replace("(seen p2)", "(seen p9)")
    result = planner.solve(COURIER, problem, attachments=EASY)
    assert result.outcome is Outcome.PROVEN_UNSOLVABLE
    assert result.plan is None
    assert result.outcome.row.exit_code == 11


@pytest.mark.parametrize("option", ["timeout_s", "seed", "threads", "node_limit"])
def test_limits_that_make_no_sense_are_refused(option: str) -> None:
    with pytest.raises(planner.InputError, match=option):
        planner.solve(COURIER, ERRANDS, attachments=EASY, **{option: -1})  # type: ignore[arg-type]


@pytest.mark.parametrize("heuristic", planner.Heuristic)
def test_decision_epochs_are_searched_alone_under_a_named_heuristic(
    heuristic: planner.Heuristic,
) -> None:
    result = planner.solve(
        COURIER, ERRANDS, attachments=EASY, heuristic=heuristic, space="decision-epochs"
    )
    assert result.statistics.schedules == 0
    assert result.plan is not None
    # p0 to p1 to p2.
    assert result.plan.makespan == pytest.approx(6.0, abs=0.01)


def test_unknown_heuristics_and_spaces_are_refused_with_the_known_ones() -> None:
    with pytest.raises(planner.InputError, match=r"no heuristic is called luck.*temporal-ff"):
        planner.solve(COURIER, ERRANDS, attachments=EASY, heuristic="luck")
    with pytest.raises(planner.InputError, match=r"no space is called outer.*portfolio"):
        planner.solve(COURIER, ERRANDS, attachments=EASY, space="outer")
