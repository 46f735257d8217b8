"""A plan in which targets have come and gone: successors, what is left out, cheapest insertion."""

from collections.abc import Sequence

import planner
from domains import catalogue
from domains.formulation import place_of
from domains.mission_state import Activity, MeetingPoint, MissionState, RobotState, Target
from service.coordination.plan_revision import revised, with_new_targets, without_visits
from service.messages.plan import PlanStep

MARSUPIAL = catalogue.load("marsupial")


def explore(start_s: float, robot: str, origin: str, target: str) -> PlanStep:
    return PlanStep(
        start_s=start_s, action="explore", arguments=[robot, origin, target], duration_s=10.0
    )


def state(targets: Sequence[Target], **activities: Activity) -> MissionState:
    """A carrier at x = 0 m, and a rover at x = 50 m or aboard."""
    rover = activities.get("rover", Activity.FREE)
    return MissionState(
        time_s=0.0,
        robots=(
            RobotState("c", "carrier", (0.0, 0.0)),
            RobotState("r", "rover", (50.0, 0.0), rover, "c" if rover is Activity.DOCKED else None),
        ),
        targets=tuple(targets),
        meeting_points=(MeetingPoint("m", (20.0, 0.0)),),
        capacities={"c": 1},
    )


def along_the_line(now: MissionState) -> "Line":
    names = MARSUPIAL.names(now)
    places: list[Target | MeetingPoint] = [*now.targets, *now.meeting_points]
    x_m = {names.name(place.id): place.position_m[0] for place in places}
    x_m |= {names.name(place_of(robot.id)): robot.position_m[0] for robot in now.robots}
    return Line(x_m)


class Line:
    """Everything lies on a line, and everybody drives 1 m/s."""

    def __init__(self, x_m: dict[str, float]) -> None:
        self.x_m = x_m

    def __call__(self, _robot: str, start: str, goal: str) -> float:
        return abs(self.x_m[start] - self.x_m[goal])


PLAN = [explore(0.0, "c", "c place", "a"), explore(10.0, "c", "a", "b")]


def test_a_target_that_moved_on_is_replaced_by_the_nearest_new_one() -> None:
    now = state([Target("b", (30.0, 0.0)), Target("near", (14.0, 0.0)), Target("far", (15.5, 0.0))])
    revision = revised(PLAN, (), now, {"a": (10.0, 0.0), "b": (30.0, 0.0)})
    assert revision.successors == {"a": "near"}
    assert [step.arguments for step in revision.steps] == [
        ["c", "c place", "near"],
        ["c", "near", "b"],
    ]


def test_a_target_that_is_gone_for_good_is_left_out() -> None:
    now = state([Target("b", (30.0, 0.0)), Target("elsewhere", (16.5, 0.0))])
    revision = revised(PLAN, (), now, {"a": (10.0, 0.0), "b": (30.0, 0.0)})
    assert revision.gone == {"a"}
    assert [step.arguments for step in revision.steps] == [["c", "c place", "b"]]


def test_what_was_visited_is_not_gone() -> None:
    now = state([Target("b", (30.0, 0.0))])
    revision = revised(PLAN, ["a"], now, {"a": (10.0, 0.0), "b": (30.0, 0.0)})
    assert (revision.gone, revision.successors) == (frozenset(), {})
    assert list(revision.steps) == PLAN


def native(*steps: tuple[float, str, tuple[str, ...]]) -> planner.Plan:
    return planner.Plan(tuple(planner.Step(start, name, args, 10.0) for start, name, args in steps))


def ways(plan: planner.Plan) -> list[tuple[str, ...]]:
    return [(step.action, *step.arguments) for step in plan]


def test_a_new_target_becomes_a_stop_on_the_way() -> None:
    now = state([Target("a", (10.0, 0.0)), Target("b", (30.0, 0.0)), Target("n", (22.0, 0.0))])
    plan = native((0.0, "explore", ("c", "c_place", "a")), (10.0, "explore", ("c", "a", "b")))
    inserted = with_new_targets(plan, {"a", "b", "n"}, now, MARSUPIAL, along_the_line(now))
    assert ways(inserted) == [
        ("explore", "c", "c_place", "a"),
        ("explore", "c", "a", "n"),
        ("explore", "c", "n", "b"),
    ]


def test_the_robot_with_the_shorter_detour_takes_it() -> None:
    now = state([Target("a", (10.0, 0.0)), Target("n", (45.0, 0.0))])
    plan = native((0.0, "explore", ("c", "c_place", "a")))
    inserted = with_new_targets(plan, {"a", "n"}, now, MARSUPIAL, along_the_line(now))
    assert ("explore", "r", "r_place", "n") in ways(inserted)


def test_nobody_stops_between_arriving_and_undocking_nor_while_aboard() -> None:
    now = state([Target("n", (20.5, 0.0))], rover=Activity.DOCKED)
    plan = native(
        (0.0, "move", ("c", "c_place", "m")),
        (20.0, "undock", ("r", "c", "m")),
    )
    cost = along_the_line(now)
    inserted = with_new_targets(plan, {"n"}, now, MARSUPIAL, cost)
    assert ways(inserted) == [
        ("move", "c", "c_place", "m"),
        ("undock", "r", "c", "m"),
        ("explore", "c", "m", "n"),
    ]


def test_what_nobody_can_reach_stays_out() -> None:
    now = state([Target("n", (20.5, 0.0))])

    def nowhere(_robot: str, _start: str, _goal: str) -> float:
        return float("inf")

    assert not with_new_targets(planner.Plan(()), {"n"}, now, MARSUPIAL, nowhere)


def test_a_robot_goes_on_from_before_the_visit_that_is_left_out() -> None:
    (step,) = without_visits(PLAN, {"a"})
    assert (step.start_s, step.arguments) == (10.0, ["c", "c place", "b"])
    assert without_visits(PLAN, ()) == tuple(PLAN)
