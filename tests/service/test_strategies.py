"""What each strategy orders in a corridor where the right answer can be told by eye."""

from dataclasses import replace

import numpy as np
import pytest

from domains.formulation import OrderKind
from semantic_attachments.contract import Memory
from semantic_attachments.robot_model import RobotModel
from service.coordination.strategies import all_strategies, serves
from service.coordination.strategy import NoPlanError, Proposal, Situation
from tests.service.corridor import corridor

DISASTER = [name for name, strategy in all_strategies().items() if serves(strategy, "disaster")]
STAYING = ("hungarian-literal",)


def orders(name: str, situation: Situation) -> dict[str, tuple[OrderKind, str | None]]:
    """Robot -> kind and place."""
    proposal: Proposal = all_strategies()[name].propose(situation, Memory())
    return {a.robot: (a.kind, a.location) for a in proposal.assignments}


@pytest.mark.parametrize("name", DISASTER)
def test_each_explorer_goes_to_its_own_end(name: str) -> None:
    ordered = orders(name, corridor({"a": 10.0, "b": 30.0}, {}, {"left": 2.0, "right": 38.0}))
    assert ordered == {"a": (OrderKind.EXPLORE, "left"), "b": (OrderKind.EXPLORE, "right")}


@pytest.mark.parametrize("name", DISASTER)
def test_a_clearer_at_a_blockade_clears_it(name: str) -> None:
    ordered = orders(
        name, corridor({"a": 5.0}, {"c": 19.0}, {"far": 38.0}, {"wall": 20.0}, {"c": "wall"})
    )
    assert ordered["c"] == (OrderKind.CLEAR, "wall")


@pytest.mark.parametrize("name", DISASTER)
def test_a_clearer_goes_to_the_blockade(name: str) -> None:
    ordered = orders(name, corridor({"a": 5.0}, {"c": 10.0}, {"far": 38.0}, {"wall": 20.0}))
    assert ordered["c"] == (OrderKind.MOVE, "wall")


@pytest.mark.parametrize("name", sorted({*DISASTER} - {"planner"}))
def test_an_explorer_with_sealed_targets_waits_at_the_blockade_or_stays(name: str) -> None:
    ordered = orders(name, corridor({"a": 5.0}, {"c": 10.0}, {"far": 38.0}, {"wall": 20.0}))
    expected = None if name in STAYING else (OrderKind.MOVE, "wall")
    assert ordered.get("a") == expected


def test_only_the_nearest_explorers_wait_at_a_blockade() -> None:
    crowd = {f"e{number}": 2.0 + 3.0 * number for number in range(6)}
    told = orders("hungarian", corridor(crowd, {"c": 1.0}, {"far": 38.0}, {"b": 30.0}))
    waits = (OrderKind.MOVE, "b")
    assert told == {"c": waits} | {f"e{number}": waits for number in range(2, 6)}


def test_one_step_rules_differ_where_greed_costs() -> None:
    # Together, a to `near` and b to `far` is 4 + 16 m, the nearest pair first 1 + 21 m.
    situation = corridor({"a": 10.0, "b": 15.0}, {}, {"near": 14.0, "far": 31.0})
    assert orders("hungarian", situation)["a"][1] == "near"
    situation = corridor({"a": 10.0, "b": 14.0}, {}, {"near": 13.0, "left": 1.0})
    assert orders("nearest", situation) == {
        "a": (OrderKind.EXPLORE, "left"),
        "b": (OrderKind.EXPLORE, "near"),
    }


def test_greedy_clearing_clears_what_no_target_needs() -> None:
    situation = corridor(
        {"a": 5.0}, {"c": 24.0}, {"here": 8.0, "beyond": 14.0}, {"needed": 10.0, "idle": 30.0}
    )
    assert orders("greedy-clearing", situation)["c"] == (OrderKind.MOVE, "idle")
    assert orders("planner", situation)["c"] == (OrderKind.MOVE, "needed")


def test_a_strategy_is_not_made_for_every_domain() -> None:
    strategy = all_strategies()["greedy-clearing"]
    assert not serves(strategy, "marsupial")
    situation = corridor({"a": 5.0}, {}, {"here": 8.0})
    object.__setattr__(situation, "domain", "marsupial")
    with pytest.raises(NoPlanError, match="only for disaster"):
        strategy.propose(situation, Memory())


def test_nothing_to_do_is_said() -> None:
    with pytest.raises(NoPlanError, match="no robot can reach"):
        orders("hungarian-literal", corridor({"a": 5.0}, {}, {"far": 38.0}, {"wall": 20.0}))


def test_that_nobody_enters_what_is_left_is_said_also_while_exploring() -> None:
    hall = corridor({"c": 5.0}, {"r": 8.0}, {"beyond": 35.0})
    terrain = np.zeros(hall.grid.cells.shape, dtype=np.uint8)
    terrain[:, 120:] = 1
    situation = replace(
        hall,
        domain="marsupial",
        state=replace(
            hall.state,
            robots=tuple(
                replace(robot, type={"explorer": "carrier", "clearer": "rover"}[robot.type])
                for robot in hall.state.robots
            ),
            capacities={"c": 1},
        ),
        grid=replace(hall.grid, terrain=terrain, terrain_classes=("default", "mire")),
        models={
            "carrier": RobotModel("carrier", 0.3, 1.0, capacity=1),
            "rover": RobotModel("rover", 0.3, 0.5),
        },
    )
    planner = all_strategies()["planner"]
    with pytest.raises(NoPlanError, match="no robot can reach beyond"):
        planner.propose(situation, Memory())
    # The simple orders are asked too, as somebody may get near enough to see what is there.
    with pytest.raises(NoPlanError, match="no robot can reach a target or a meeting point"):
        planner.propose(replace(situation, exploring=True), Memory())
