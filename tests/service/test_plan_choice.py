"""A team that explores goes where it is going unless something clearly better turns up."""

import planner
from domains import catalogue
from domains.mission_state import MissionState, RobotState, Target
from service.coordination.plan_choice import PROMPTNESS, steadiest, worth_s

MARSUPIAL = catalogue.load("marsupial")
STATE = MissionState(
    time_s=0.0,
    robots=(RobotState("c", "carrier", (0.0, 0.0)),),
    targets=(Target("a", (1.0, 0.0)), Target("b", (2.0, 0.0))),
)


def plan(*visits: tuple[str, float]) -> planner.Plan:
    """The carrier's visits, each with the time it ends [s]."""
    steps, place, start_s = [], "c_place", 0.0
    for target, end_s in visits:
        steps.append(planner.Step(start_s, "explore", ("c", place, target), end_s - start_s))
        place, start_s = target, end_s
    return planner.Plan(tuple(steps))


def test_mean_time_counts_beside_the_last() -> None:
    names = MARSUPIAL.names(STATE)
    assert worth_s(plan(("a", 10.0), ("b", 30.0)), MARSUPIAL, names) == 30.0 + PROMPTNESS * 20.0


def test_a_small_gain_is_no_reason_to_turn_round() -> None:
    steady, other = plan(("a", 50.0), ("b", 100.0)), plan(("b", 50.0), ("a", 96.0))
    assert steadiest([steady, other], {"c": "a"}, MARSUPIAL, STATE) is steady


def test_a_clear_gain_is() -> None:
    steady, other = plan(("a", 50.0), ("b", 100.0)), plan(("b", 50.0), ("a", 90.0))
    assert steadiest([steady, other], {"c": "a"}, MARSUPIAL, STATE) is other


def test_of_the_plans_that_go_on_the_best_counts() -> None:
    first, second = plan(("a", 60.0), ("b", 100.0)), plan(("a", 50.0), ("b", 99.0))
    other = plan(("b", 50.0), ("a", 98.0))
    assert steadiest([first, second, other], {"c": "a"}, MARSUPIAL, STATE) is second


def test_a_team_that_goes_nowhere_takes_the_best() -> None:
    one, best = plan(("a", 50.0), ("b", 100.0)), plan(("b", 50.0), ("a", 99.9))
    assert steadiest([one, best], {}, MARSUPIAL, STATE) is best


def test_where_no_plan_goes_on_the_best_counts() -> None:
    best = plan(("b", 50.0), ("a", 99.9))
    assert steadiest([best], {"c": "a"}, MARSUPIAL, STATE) is best
