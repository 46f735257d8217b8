"""Robots that a plan leaves without an order explore too; where nothing is unknown they do not."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from domains.formulation import Assignment, OrderKind
from domains.mission_state import Activity, MissionState, RobotState, Target
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.exploration.idle_explorers import IdleExplorers
from service.coordination.strategies import all_strategies
from service.coordination.strategy import Proposal, Situation
from service.messages.mission import PlanningMessage


@dataclass(frozen=True)
class Planned:
    """A plan that needs these robots only."""

    orders: tuple[Assignment, ...]

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        del situation, memory
        return Proposal(self.orders, "planned", validated=True)


def hall(*robots: RobotState) -> Situation:
    """40 m long, targets at 5, 20 and 35 m."""
    cells = np.full((12, 200), 100, dtype=np.int8)
    cells[1:-1, 1:-1] = 0
    targets = tuple(Target(f"frontier {x:g}", (x, 1.2)) for x in (5.0, 20.0, 35.0))
    return Situation(
        domain="disaster",
        state=MissionState(time_s=0.0, robots=robots, targets=targets),
        grid=GridMap(cells, 0.2),
        models={
            "explorer": RobotModel(
                type="explorer", radius_m=0.25, speed_m_s=0.5, sensor_range_m=5.0
            )
        },
        planning=PlanningMessage(),
        trigger="test",
        exploring=True,
    )


def robot(name: str, x: float, activity: Activity = Activity.FREE) -> RobotState:
    return RobotState(name, "explorer", (x, 1.2), activity=activity)


PLANNED = Assignment("a", OrderKind.EXPLORE, "frontier 20")
AT = {"a": robot("a", 19.0), "b": robot("b", 18.0), "c": robot("c", 24.0), "d": robot("d", 21.0)}


def test_idle_robots_go_to_the_nearest_frontiers_that_nobody_goes_to() -> None:
    proposal = IdleExplorers(Planned((PLANNED,))).propose(hall(AT["a"], AT["b"], AT["c"]), Memory())
    assert [(order.robot, order.location) for order in proposal.assignments] == [
        ("a", "frontier 20"),
        ("b", "frontier 5"),
        ("c", "frontier 35"),
    ]
    assert proposal.assignments[1].expected_duration_s == pytest.approx(26.0, abs=1.0)
    assert proposal.validated
    assert proposal.reason == "planned; 2 more to the nearest frontiers"


def test_more_robots_than_frontiers_share_them() -> None:
    orders = (
        PLANNED,
        *(Assignment(n, OrderKind.EXPLORE, f"frontier {x}") for n, x in (("b", 5), ("c", 35))),
    )
    proposal = IdleExplorers(Planned(orders)).propose(hall(*AT.values()), Memory())
    assert (proposal.assignments[3].robot, proposal.assignments[3].location) == ("d", "frontier 20")


def test_a_waiting_robot_is_idle_and_a_robot_that_is_not_free_is_not() -> None:
    orders = (PLANNED, Assignment("b", OrderKind.WAIT, "frontier 5"))
    broken = robot("c", 24.0, Activity.FAILED)
    proposal = IdleExplorers(Planned(orders)).propose(hall(AT["a"], AT["b"], broken), Memory())
    assert [(order.robot, order.kind) for order in proposal.assignments] == [
        ("a", OrderKind.EXPLORE),
        ("b", OrderKind.EXPLORE),
    ]


def test_where_all_is_known_a_plan_stays_as_it_is() -> None:
    situation = replace(hall(*AT.values()), exploring=False)
    proposal = IdleExplorers(Planned((PLANNED,))).propose(situation, Memory())
    assert proposal.assignments == (PLANNED,)
    assert proposal.reason == "planned"


def test_the_planner_s_fallback_is_still_known() -> None:
    assert getattr(all_strategies()["planner"], "fallback", None) is not None
