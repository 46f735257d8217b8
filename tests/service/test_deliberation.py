"""A decision's effort when others wait, what comes of a fault, and what is decided instead."""

from dataclasses import replace

import numpy as np
import pytest

from domains.mission_state import MissionState, RobotState, Target
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.deliberation import LEAST_TIME_LIMIT_S, Deliberation, shared
from service.coordination.strategies import all_strategies
from service.coordination.strategy import NoPlanError, Proposal, Situation
from service.jobs.executor import Told
from service.messages.mission import PlanningMessage
from service.messages.plan import PlanStep
from service.messages.report import Command

PLANNER = all_strategies()["planner"]
MODEL = RobotModel(type="explorer", radius_m=0.3, speed_m_s=1.0, sensor_range_m=5.0)


def situation(x_m: float = 2.5) -> Situation:
    """An explorer in a hall with two targets."""
    return Situation(
        domain="disaster",
        state=MissionState(
            time_s=0.0,
            robots=(RobotState("e", "explorer", (x_m, 2.5)),),
            targets=(Target("near", (6.5, 2.5)), Target("far", (16.5, 2.5))),
            blockades=(),
            meeting_points=(),
            capacities={},
        ),
        grid=GridMap(np.zeros((5, 20), dtype=np.int8), 1.0),
        models={"explorer": MODEL},
        planning=PlanningMessage(time_limit_s=0.2),
        trigger="a test",
    )


def deliberation(of: Situation) -> Deliberation:
    return Deliberation("m", "fleet", PLANNER, of)


@pytest.mark.parametrize(
    ("share_s", "node_limit", "expected_s"),
    [(1.0, None, 0.2), (0.1, None, 0.1), (0.001, None, LEAST_TIME_LIMIT_S), (0.001, 9, 0.2)],
)
def test_decisions_share_the_time(
    share_s: float, node_limit: int | None, expected_s: float
) -> None:
    asked = replace(situation(), planning=PlanningMessage(time_limit_s=0.2, node_limit=node_limit))
    got = shared(asked, share_s)
    assert got.planning.time_limit_s == pytest.approx(expected_s)
    assert got.hurried is (expected_s < 0.2)


def test_a_hurried_decision_goes_on_with_a_plan_that_is_on_time_and_seeks_one_otherwise() -> None:
    memory = Memory()
    planned = deliberation(situation()).decide(memory).proposal
    assert not planned.keeps_plan
    assert [step.arguments[-1] for step in planned.steps] == ["near", "far"]
    near = Command(
        id="r1-e", robot="e", kind="explore", location="near", path_m=[], revision=1
    )  # fmt: skip
    reached = situation(x_m=6.5)
    reached = replace(
        reached,
        state=replace(reached.state, time_s=4.0, targets=reached.state.targets[1:]),
        in_force=tuple(PlanStep.model_validate(s.model_dump()) for s in planned.steps),
        done=(near,),
        hurried=True,
    )
    kept = deliberation(reached).decide(memory).proposal
    assert kept.keeps_plan
    assert "others wait" in kept.reason
    assert [assignment.location for assignment in kept.assignments] == ["far"]
    # Another target that the plan does not know: nothing to go on with.
    more = replace(
        reached,
        state=replace(reached.state, targets=(*reached.state.targets, Target("new", (10.5, 2.5)))),
    )
    assert not deliberation(more).decide(memory).proposal.keeps_plan


class Refusing:
    """Knows no way; its fallback has a fault."""

    class Fallback:
        def propose(self, _: Situation, __: Memory) -> Proposal:
            raise ZeroDivisionError("a fault")

    fallback = Fallback()

    def propose(self, _: Situation, __: Memory) -> Proposal:
        raise NoPlanError("nobody can do anything")


def test_faults_are_told_and_the_fallback_is_simpler() -> None:
    told: list[Told] = []
    refusing = Deliberation("m", "fleet", Refusing(), situation())
    refusing.answer(told.append, Memory())
    refusing.simpler().answer(told.append, Memory())
    assert [(one["kind"], one["outcome"]) for one in told] == [
        ("failed", "no_plan"),
        ("failed", "faulty"),
    ]
    assert "nobody can" in told[0]["message"]
    assert deliberation(situation()).simpler().strategy is PLANNER.fallback  # type: ignore[attr-defined]
