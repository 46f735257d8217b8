"""The engine `marsupial` of unified-planning on every problem that unified-planning ships."""

from fractions import Fraction

import pytest
import unified_planning.shortcuts as up
from unified_planning.engines import PlanGenerationResultStatus as Status
from unified_planning.engines import ValidationResultStatus
from unified_planning.engines.plan_validator import (
    SequentialPlanValidator,
    TimeTriggeredPlanValidator,
)
from unified_planning.exceptions import UPUsageError
from unified_planning.plans import ActionInstance, TimeTriggeredPlan
from unified_planning.test.examples import get_example_problems

import planner
from planner.unified_planning_engine import NAME, MarsupialEngine

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:unified_planning")

EXAMPLES = {
    name: example
    for name, example in get_example_problems().items()
    if isinstance(example.problem, up.Problem)
}
SUPPORTED = sorted(n for n, e in EXAMPLES.items() if MarsupialEngine.supports(e.problem.kind))
DECLINED = {
    "1d_movement": "PROCESSES",
    "basic_bool_fluent_param": "BOOL_FLUENT_PARAMETERS",
    "basic_bounded_int_action_param": "BOUNDED_INT_ACTION_PARAMETERS",
    "basic_int_fluent_param": "BOUNDED_INT_FLUENT_PARAMETERS",
    "basic_oversubscription": "OVERSUBSCRIPTION",
    "basic_unbounded_int_action_param": "UNBOUNDED_INT_ACTION_PARAMETERS",
    "basic_undef_bool": "UNDEFINED_INITIAL_SYMBOLIC",
    "basic_with_default_values": "OBJECT_FLUENTS",
    "boiling_water": "PROCESSES",
    "durative_continuous_example": "INCREASE_CONTINUOUS_EFFECTS",
    "htn-go": "HIERARCHICAL",
    "htn-go-temporal": "HIERARCHICAL",
    "locations_connected_visited_oversubscription": "OVERSUBSCRIPTION",
    "robot_conditional_effects": "DECREASE_CONTINUOUS_EFFECTS",
    "robot_continuous": "DECREASE_CONTINUOUS_EFFECTS",
    "robot_fluent_of_user_type": "OBJECT_FLUENTS",
    "robot_fluent_of_user_type_with_int_id": "OBJECT_FLUENTS",
    "robot_non_linear_continuous_1": "NON_LINEAR_CONTINUOUS_EFFECTS",
    "robot_with_static_fluents_duration_timed_goals": "TIMED_GOALS",
    "timed_connected_locations": "INTERMEDIATE_CONDITIONS_AND_EFFECTS",
}
"""Every other problem, and the feature that we do not do."""


@pytest.fixture(autouse=True)
def _without_credits() -> None:
    up.get_environment().credits_stream = None


def test_every_problem_is_solved_or_declined_by_name() -> None:
    assert len(SUPPORTED) >= 40
    assert sorted(set(EXAMPLES) - set(SUPPORTED)) == sorted(DECLINED)
    ours = MarsupialEngine.supported_kind().features
    for name, feature in DECLINED.items():
        assert feature in EXAMPLES[name].problem.kind.features - ours


@pytest.mark.filterwarnings("ignore::UserWarning:unified_planning")
@pytest.mark.parametrize("name", SUPPORTED)
def test_what_is_supported_is_solved(name: str) -> None:
    example = EXAMPLES[name]
    problem = example.problem
    with up.OneshotPlanner(name=NAME) as engine:
        result = engine.solve(problem, timeout=1)
    assert example.solvable
    assert result.status in {Status.SOLVED_OPTIMALLY, Status.SOLVED_SATISFICING}
    temporal = problem.kind.has_continuous_time()
    judge = TimeTriggeredPlanValidator() if temporal else SequentialPlanValidator()
    judge.skip_checks = True
    assert judge.validate(problem, result.plan).status is ValidationResultStatus.VALID


def test_a_problem_without_plan_is_proved_so() -> None:
    problem = EXAMPLES["matchcellar"].problem.clone()
    for fluent in list(problem.explicit_initial_values):
        if fluent.fluent().name == "handfree":
            problem.set_initial_value(fluent, False)
    with up.OneshotPlanner(name=NAME) as engine:
        result = engine.solve(problem)
    assert result.status is Status.UNSOLVABLE_PROVEN
    assert result.plan is None


def test_anytime_plans_improve_and_the_last_result_is_final() -> None:
    problem = EXAMPLES["matchcellar"].problem.clone()
    problem.add_quality_metric(up.MinimizeMakespan())
    with up.AnytimePlanner(name=NAME, anytime_guarantee="INCREASING_QUALITY") as engine:
        results = list(engine.get_solutions(problem, timeout=2))
    assert all(result.status is Status.INTERMEDIATE for result in results[:-1])
    makespans = [float(result.metrics["makespan"]) for result in results[:-1]]
    assert makespans == sorted(makespans, reverse=True)
    assert results[-1].status in {Status.SOLVED_OPTIMALLY, Status.SOLVED_SATISFICING}
    assert results[-1].plan == results[-2].plan


def test_the_replanner_follows_its_problem() -> None:
    problem = EXAMPLES["matchcellar_static_duration"].problem
    with up.Replanner(problem, name=NAME) as engine:
        first = engine.resolve(timeout=2)
        goal = problem.goals[0]
        engine.remove_goal(goal)
        second = engine.resolve(timeout=2)
        engine.add_goal(goal)
        engine.remove_action("light_match")
        third = engine.resolve(timeout=2)
        engine.add_action(problem.action("light_match"))
        fourth = engine.resolve(timeout=2)
        with pytest.warns(UserWarning, match="is not in the problem"):
            engine.remove_action("light_matches")
    assert len(second.plan.timed_actions) < len(first.plan.timed_actions)
    assert third.status is Status.UNSOLVABLE_PROVEN
    assert len(fourth.plan.timed_actions) == len(first.plan.timed_actions)


def travel_problem() -> up.Problem:
    """Two robots; how long they travel is nowhere in the problem."""
    problem = up.Problem("travel")
    place, robot = up.UserType("place"), up.UserType("robot")
    at = problem.add_fluent("at", up.BoolType(), default_initial_value=False, r=robot, p=place)
    seen = problem.add_fluent("seen", up.BoolType(), default_initial_value=False, p=place)
    travel_time = problem.add_fluent("travel_time", up.RealType(), r=robot, a=place, b=place)
    drive = up.DurativeAction("drive", r=robot, a=place, b=place)
    drive.set_fixed_duration(travel_time(drive.r, drive.a, drive.b))
    drive.add_condition(up.StartTiming(), at(drive.r, drive.a))
    drive.add_effect(up.StartTiming(), at(drive.r, drive.a), False)
    drive.add_effect(up.EndTiming(), at(drive.r, drive.b), True)
    drive.add_effect(up.EndTiming(), seen(drive.b), True)
    problem.add_action(drive)
    robots = [problem.add_object(f"Robot_{index}", robot) for index in range(2)]
    places = [problem.add_object(f"Place_{index}", place) for index in range(3)]
    problem.set_initial_value(at(robots[0], places[0]), True)
    problem.set_initial_value(at(robots[1], places[0]), True)
    problem.add_goal(seen(places[1]))
    problem.add_goal(seen(places[2]))
    return problem


def travel_time(robot: str, a: str, b: str) -> float:
    """The second robot is twice as slow."""
    distance = abs(int(a.removeprefix("Place_")) - int(b.removeprefix("Place_")))
    return 3.0 * distance * (1 + int(robot.removeprefix("Robot_")))


def test_attachments_compute_fluents() -> None:
    problem = travel_problem()
    params = {"attachments": {"travel_time": travel_time}}
    with up.OneshotPlanner(name=NAME, params=params) as engine:
        result = engine.solve(problem, timeout=2)
    assert max(start + duration for start, _, duration in result.plan.timed_actions) == 6
    with up.PlanValidator(name=NAME, params=params) as engine:
        assert engine.validate(problem, result.plan).status is ValidationResultStatus.VALID


def test_an_attachment_that_fails_stops_planning() -> None:
    def broken(*_: str) -> float:
        raise ValueError("the map is lost")

    params = {"attachments": {"travel_time": broken}}
    with (
        up.OneshotPlanner(name=NAME, params=params) as engine,
        pytest.raises(planner.AttachmentError, match="the map is lost"),
    ):
        engine.solve(travel_problem())


def test_validation_names_what_is_wrong() -> None:
    example = EXAMPLES["matchcellar"]
    problem = example.problem
    plan = example.valid_plans[0]
    with up.PlanValidator(name=NAME) as engine:
        assert engine.validate(problem, plan).status is ValidationResultStatus.VALID
        late = TimeTriggeredPlan(
            [
                (start + Fraction(100 * (index == 1)), a, d)
                for index, (start, a, d) in enumerate(plan.timed_actions)
            ]
        )
        verdict = engine.validate(problem, late)
    assert verdict.status is ValidationResultStatus.INVALID
    assert isinstance(plan.timed_actions[0][1], ActionInstance)
    assert "does not hold" in verdict.log_messages[0].message


def test_unknown_parameters_are_refused() -> None:
    with pytest.raises(UPUsageError, match="it takes attachments"):
        up.OneshotPlanner(name=NAME, params={"heuristics": 1})
