"""Our validator against unified-planning's time-triggered validator, on thousands of mutated plans.

docs/validator.md explains the three disagreements that are expected; every other one fails.
"""

import random
import re
from collections import Counter
from fractions import Fraction

import pytest
import unified_planning.shortcuts as up
from unified_planning.engines import ValidationResultStatus
from unified_planning.engines.plan_validator import TimeTriggeredPlanValidator
from unified_planning.exceptions import UPUsageError
from unified_planning.io import PDDLReader
from unified_planning.plans import TimeTriggeredPlan

import planner
from tests.planner.problems import EXAMPLES, Example

MUTANTS = 700
# Equal times only: what is equal in their fractions may differ in the last bit of our numbers.
EXACT_S = 1e-8
CHANGE = re.compile(r"\) (adds|deletes|increases|decreases|assigns) ")


def mutate(plan: planner.Plan, problem: planner.Problem, draw: random.Random) -> planner.Plan:
    """One to three random edits: times, durations, arguments, actions, steps left out, doubled
    or exchanged.
    """
    steps = list(plan.steps)
    objects = sorted(problem.objects)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        if not steps:
            break
        index = draw.randrange(len(steps))
        step = steps[index]
        match draw.randrange(7):
            case 0:
                start = draw.choice(
                    [other.start for other in steps] + [other.end for other in steps]
                )
                steps[index] = replace(step, start=start)
            case 1:
                start = max(
                    0.0, round(step.start + draw.choice((-3, -1, -0.5, 0.001, 0.5, 1, 3)), 3)
                )
                steps[index] = replace(step, start=start)
            case 2 if step.duration is not None:
                duration = max(0.001, round(step.duration + draw.choice((-1, -0.5, 0.5, 1)), 3))
                steps[index] = replace(step, duration=duration)
            case 3 if step.arguments:
                arguments = list(step.arguments)
                arguments[draw.randrange(len(arguments))] = draw.choice(objects)
                steps[index] = replace(step, arguments=tuple(arguments))
            case 4:
                del steps[index]
            case 5:
                steps.append(replace(step, start=round(step.start + draw.choice((0, 1, 2.5)), 3)))
            case _:
                other = draw.randrange(len(steps))
                steps[index], steps[other] = (
                    replace(step, start=steps[other].start),
                    replace(steps[other], start=step.start),
                )
    return planner.Plan(tuple(sorted(steps, key=lambda one: one.start)))


def replace(step: planner.Step, **changes: object) -> planner.Step:
    fields = {
        "start": step.start,
        "action": step.action,
        "arguments": step.arguments,
        "duration": step.duration,
    }
    return planner.Step(**(fields | changes))  # type: ignore[arg-type]


def theirs(problem: up.Problem, plan: planner.Plan) -> tuple[bool, str] | None:
    """Their verdict and messages.

    None where an argument has the wrong type, which they do not let us express.
    """
    timed = []
    for step in plan:
        action = problem.action(step.action)
        arguments = []
        for parameter, name in zip(action.parameters, step.arguments, strict=True):
            found = problem.object(name)
            if not parameter.type.is_compatible(found.type):
                return None
            arguments.append(found)
        duration = None if step.duration is None else Fraction(str(step.duration))
        timed.append((Fraction(str(step.start)), action(*arguments), duration))
    validator = TimeTriggeredPlanValidator()
    validator.skip_checks = True  # their check of the kind of problem refuses numbers that work
    try:
        result = validator.validate(problem, TimeTriggeredPlan(timed))
    except UPUsageError as error:
        if "does not have a value" not in str(error):
            raise
        return False, str(error)
    messages = " ".join(log.message for log in result.log_messages or ())
    return result.status == ValidationResultStatus.VALID, messages


@pytest.mark.filterwarnings("ignore::DeprecationWarning:unified_planning")
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_verdicts_agree(example: Example) -> None:
    problem = planner.read_problem(example.domain, example.problem)
    plan = planner.read_plan(problem, example.plan)
    reader = PDDLReader()
    other = reader.parse_problem_string(example.domain, example.problem)
    assert planner.validate(problem.domain, problem, plan)
    assert theirs(other, plan) == (True, "")

    draw = random.Random(1)
    seen: Counter[str] = Counter()
    for _ in range(MUTANTS):
        mutant = mutate(plan, problem, draw)
        verdict = planner.validate(problem.domain, problem, mutant, tolerance_s=EXACT_S)
        their_verdict = theirs(other, mutant)
        if their_verdict is None:
            assert verdict.reason == "wrong-type"
            seen["type"] += 1
            continue
        valid, messages = their_verdict
        if valid == verdict.valid:
            seen["valid" if valid else "invalid"] += 1
        elif valid and verdict.reason == "interference":
            # They check no reader against a writer at the same instant.
            assert verdict.message is not None
            assert " needs " in verdict.message, mutant
            seen["reader and writer"] += 1
        elif verdict.valid and "Conflicting effects" in messages:
            # They reject two actions that add, or two that delete, the same fact at one instant.
            assert equal_effects(problem, mutant), mutant
            seen["equal effects"] += 1
        elif valid and "over all" in (verdict.message or "") and unchanged_start(problem, mutant):
            # They check no over-all condition before the first change after the action's start.
            seen["over all"] += 1
        else:
            pytest.fail(f"ours: {verdict.message}\ntheirs: {their_verdict}\n{mutant}")
    print(example.name, seen)
    assert seen["valid"] > MUTANTS / 50, seen
    assert seen["invalid"] > MUTANTS / 4, seen


def unchanged_start(problem: planner.Problem, plan: planner.Plan) -> bool:
    """Whether the plan fails where a step starts and nothing changes."""
    verdict = planner.validate(problem.domain, problem, plan, tolerance_s=EXACT_S, report=True)
    assert verdict.step is not None
    last = max(index for index, line in enumerate(verdict.report) if line.startswith("happening"))
    changes = [line for line in verdict.report[last:] if CHANGE.search(line)]
    return plan[verdict.step].start == verdict.time and not changes


def equal_effects(problem: planner.Problem, plan: planner.Plan) -> bool:
    """Whether two occurrences of one happening add, or delete, the same fact."""
    verdict = planner.validate(problem.domain, problem, plan, tolerance_s=EXACT_S, report=True)
    changes: Counter[str] = Counter()
    for line in verdict.report:
        if line.startswith("happening"):
            changes.clear()
        for verb in (" adds ", " deletes "):
            if verb in line:
                change = line[line.index(verb) :]
                changes[change] += 1
                if changes[change] > 1:
                    return True
    return False
