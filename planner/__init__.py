"""Temporal planning with semantic attachments: reads, solves and validates PDDL 2.1 with PDDL/M.

>>> import planner
>>> domain = planner.read_domain('''
...     (define (domain lamp)
...       (:requirements :durative-actions)
...       (:predicates (lit))
...       (:durative-action switch :parameters () :duration (= ?duration 2)
...        :condition () :effect (at end (lit))))''')
>>> problem = planner.read_problem(
...     domain, "(define (problem one) (:domain lamp) (:init) (:goal (lit)))"
... )
>>> result = planner.solve(domain, problem)
>>> result.outcome.value, result.plan.makespan
('solved_optimally', 2.0)
>>> planner.validate(domain, problem, "0: (switch) [3]").message
'happening 1, time 0: (switch) (step 1): its duration is 3 but must be = 2'
"""

from planner._core import Domain, Module, Problem, State
from planner.attachments import Attachment, Attachments, BatchAttachment
from planner.diagnostics import AttachmentError, Diagnostic, InternalError, PddlError, PlannerError
from planner.outcome import OUTCOMES, Outcome, OutcomeRow
from planner.plan import Plan, Step
from planner.reading import InputError, read_domain, read_plan, read_problem
from planner.solving import (
    Heuristic,
    Limits,
    Progress,
    Result,
    Space,
    Statistics,
    UnsupportedError,
    solve,
    solve_anytime,
)
from planner.validation import Verdict, validate

__all__ = [
    "OUTCOMES",
    "Attachment",
    "AttachmentError",
    "Attachments",
    "BatchAttachment",
    "Diagnostic",
    "Domain",
    "Heuristic",
    "InputError",
    "InternalError",
    "Limits",
    "Module",
    "Outcome",
    "OutcomeRow",
    "PddlError",
    "Plan",
    "PlannerError",
    "Problem",
    "Progress",
    "Result",
    "Space",
    "State",
    "Statistics",
    "Step",
    "UnsupportedError",
    "Verdict",
    "read_domain",
    "read_plan",
    "read_problem",
    "solve",
    "solve_anytime",
    "validate",
]
