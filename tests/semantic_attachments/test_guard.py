"""Bad attachments: each fault is an error that says what was wrong, never a wrong value."""

import math
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from semantic_attachments.contract import Attachment, EvaluationError, Kind, Parameter, Purity
from semantic_attachments.guard import Guarded

X = (Parameter("x"),)


def guarded(function: Any, *, time_limit_s: float | None = 10.0, **declaration: Any) -> Guarded:
    attachment = Attachment("tested", X, lambda *_: function, **declaration)
    return Guarded(attachment, function, time_limit_s)


def raises(x: str) -> float:
    raise RuntimeError(f"no way to {x}")


class MutatesItsInput:
    def __call__(self, *_: str) -> float:
        return 1.0

    def many(self, calls: Any) -> Any:
        calls.clear()
        return []


class Many:
    """Gives what it was made with, whatever the calls."""

    def __init__(self, values: Any) -> None:
        self.values = values

    def many(self, _: Any) -> Any:
        return self.values


@pytest.mark.parametrize("time_limit_s", [None, 10.0])
@pytest.mark.parametrize(
    ("function", "reason", "position"),
    [
        (raises, "raised RuntimeError: no way to b0", 0),
        (lambda x: math.nan if x == "b1" else 1.0, "returned NaN", 1),
        (lambda x: -1.5 if x == "b1" else 1.0, "returned -1.5; a cost is never negative", 1),
        (lambda _: None, "'None' of type NoneType; a cost is a number", 0),
        (lambda _: True, "of type bool; a cost is a number", 0),
        (lambda _: "3", "of type str", 0),
        (lambda: 1.0, "raised TypeError", 0),
        (MutatesItsInput(), "raised AttributeError: 'tuple' object has no attribute 'clear'", 0),
        (Many([1.0]), "1 values for 2 calls", 0),
        (Many(None), "no sequence", 0),
        (Many([1.0, math.nan]), "returned NaN", 1),
    ],
)
def test_a_faulty_cost(
    function: Any, reason: str, position: int, time_limit_s: float | None
) -> None:
    with pytest.raises(EvaluationError, match=reason) as caught:
        guarded(function, time_limit_s=time_limit_s).many([("b0",), ("b1",)])
    assert caught.value.position == position


def test_good_values_pass() -> None:
    values = guarded(Many([1, np.float32(2.5), math.inf])).many([("a",), ("b",), ("c",)])
    assert values == [1.0, 2.5, math.inf]
    assert guarded(lambda x: float(len(x)))("abc") == 3.0
    with pytest.raises(EvaluationError, match="takes 1 arguments, not 2"):
        guarded(lambda _: 1.0)("a", "b")


def test_a_condition_is_a_bool() -> None:
    assert guarded(lambda x: x == "a", kind=Kind.CONDITION).many([("a",), ("b",)]) == [1.0, 0.0]
    with pytest.raises(EvaluationError, match="a condition is a bool"):
        guarded(lambda _: 1.0, kind=Kind.CONDITION)("a")


def test_a_sleeper_is_given_up_and_the_next_call_works() -> None:
    def sleeper(x: str) -> float:
        time.sleep(5.0 if x == "slow" else 0.0)
        return 1.0

    attachment = guarded(sleeper, time_limit_s=0.2, thread_safe=True)
    with pytest.raises(EvaluationError, match=r"took longer than 0.2 s"):
        attachment("slow")
    assert attachment("fast") == 1.0


def test_a_quick_attachment_is_asked_in_the_thread_that_asks() -> None:
    asked_in: list[int] = []

    def note(_: str) -> float:
        asked_in.append(threading.get_ident())
        return 1.0

    assert guarded(note, time_limit_s=1.0, quick=True)("a") == 1.0
    assert guarded(note, time_limit_s=1.0)("a") == 1.0
    assert asked_in[0] == threading.get_ident() != asked_in[1]


def test_the_time_limit_holds_for_each_call_of_many() -> None:
    def sleeper(x: str) -> float:
        asked.append(x)
        time.sleep(float(x))
        return 1.0

    asked: list[str] = []
    attachment = guarded(sleeper, time_limit_s=0.5, thread_safe=True)
    assert attachment.many([("0.1",)] * 6) == [1.0] * 6
    asked.clear()
    with pytest.raises(EvaluationError, match=r"took longer than 0.5 s") as caught:
        attachment.many([("0",), ("0.05",), ("1.2",), ("0",)])
    assert caught.value.position == 2
    time.sleep(1.0)
    assert asked == ["0", "0.05", "1.2"]


def test_one_that_asks_itself_is_refused() -> None:
    asked: list[Guarded] = []

    def asks_itself(x: str) -> float:
        return asked[0](x)

    for limit_s in (None, 10.0):
        asked[:] = [guarded(asks_itself, time_limit_s=limit_s)]
        with pytest.raises(EvaluationError, match="it asks itself through the planner"):
            asked[0]("a")


class State:
    """A state of facts and values; reading what is not there is a KeyError, as in the planner."""

    def __init__(self, values: Mapping[tuple[str, ...], float], *facts: tuple[str, ...]) -> None:
        self._values, self._facts = values, facts

    def holds(self, predicate: str, *arguments: str) -> bool:
        return (predicate, *arguments) in self._facts

    def value(self, function: str, *arguments: str) -> float | None:
        if function != "energy":
            raise KeyError(function)
        return self._values.get((function, *arguments))


@pytest.mark.parametrize("time_limit_s", [None, 10.0])
def test_values_are_remembered_by_the_fluents_read(time_limit_s: float | None) -> None:
    asked = []

    def cost(state: State, robot: str) -> float:
        asked.append(robot)
        return 10 * (state.value("energy", robot) or 0) + state.holds("wet", robot)

    attachment = guarded(
        cost,
        time_limit_s=time_limit_s,
        purity=Purity.FLUENTS,
        reads=(("energy", "x"), ("wet", "x")),
    )
    assert attachment.purity == "fluents"
    dry, wet = State({("energy", "r"): 2.0}), State({("energy", "r"): 2.0}, ("wet", "r"))
    assert [attachment(dry, "r"), attachment(wet, "r"), attachment(dry, "r")] == [20, 21, 20]
    assert asked == ["r", "r"]


def test_reading_what_is_not_declared_is_refused() -> None:
    def sneaks(state: State, robot: str) -> float:
        return float(state.holds("wet", robot))

    attachment = guarded(sneaks, purity=Purity.FLUENTS, reads=(("energy", "x"),))
    with pytest.raises(EvaluationError, match=r"reads \(wet r\), which its `reads` does not name"):
        attachment(State({}), "r")


@pytest.mark.parametrize(("result", "expected"), [([1, 2.5], [1.0, 2.5]), (None, None), ((), [])])
def test_effects_give_new_values_or_none(result: Any, expected: Any) -> None:
    attachment = guarded(lambda _state, _x: result, kind=Kind.EFFECT, purity=Purity.STATE)
    assert attachment(State({}), "r") == expected


@pytest.mark.parametrize("result", [[math.nan], ["1"], 3.0])
def test_a_faulty_effect(result: Any) -> None:
    effect: Callable[..., Any] = lambda _state, _x: result  # noqa: E731
    attachment = guarded(effect, kind=Kind.EFFECT, purity=Purity.STATE)
    with pytest.raises(EvaluationError, match="it returned"):
        attachment(State({}), "r")


def test_a_declaration_that_contradicts_itself_is_refused() -> None:
    with pytest.raises(ValueError, match="reads 'y', no parameter"):
        guarded(raises, purity=Purity.FLUENTS, reads=(("energy", "y"),))
    with pytest.raises(ValueError, match="if and only if purity is FLUENTS"):
        guarded(raises, reads=(("energy", "x"),))
