"""Finding attachments and binding them."""

import math
from dataclasses import dataclass

import pytest

from semantic_attachments import Attachment, BindingError, Memory, World, bind
from semantic_attachments.contract import Evaluator, Kind, Parameter
from semantic_attachments.grid import Single
from semantic_attachments.registry import installed, resolve


def test_what_is_installed_is_complete() -> None:
    for name, attachment in installed().items():
        assert name == attachment.name.lower()
        assert attachment.parameters
        assert len({parameter.name for parameter in attachment.parameters}) == len(
            attachment.parameters
        )
        assert attachment.bind.__doc__ is not None or attachment.bind.__name__.startswith("_")


@pytest.mark.parametrize(
    "call",
    [
        "pathCost",
        "pathcost",
        "pathCost@libgrid.so",
        "pathCost@semantic_attachments.grid:path_costs",
    ],
)
def test_calls_resolve_by_name(call: str) -> None:
    assert resolve(call).name == "pathCost"


def test_a_call_never_imports_what_it_names() -> None:
    with pytest.raises(BindingError, match=r"no attachment is called 'open'.*known are .*pathCost"):
        resolve("open@os:system")


@dataclass
class Module:
    name: str
    call: str
    kind: str = "cost"
    parameters: tuple[str, ...] = ("r", "s", "g")


@dataclass
class Domain:
    modules: list[Module]


def test_a_domain_is_bound_under_its_own_names(two_rooms: World) -> None:
    domain = Domain(
        [
            Module("travel", "pathCost@libgrid.so"),
            Module("clear", "clearCost@x.so", parameters=("r", "b")),
        ]
    )
    bound = bind(domain, two_rooms)
    assert list(bound) == ["travel", "clear"]
    assert bound["clear"]("robot", "door") == 20.0
    assert math.isinf(bound["travel"]("robot", "west", "east"))
    assert bound["travel"].many([("robot", "west", "west")]) == [0.0]


def test_a_module_of_another_kind_is_refused(two_rooms: World) -> None:
    with pytest.raises(BindingError, match="declared as conditionchecker, but it is a cost"):
        bind(Domain([Module("pathCost", "pathCost", "conditionchecker")]), two_rooms)
    with pytest.raises(BindingError, match="declared with 1 parameters; pathCost takes 3"):
        bind(Domain([Module("pathCost", "pathCost", parameters=("r",))]), two_rooms)
    with pytest.raises(BindingError, match="ground new objects are not supported"):
        bind(Domain([Module("pathCost", "pathCost", "grounding")]), two_rooms)


def test_attachments_given_win_over_installed_ones(two_rooms: World) -> None:
    def seven(_: World, __: Memory) -> Evaluator:
        return Single(lambda *_: 7.0)

    mine = Attachment("PathCost", (Parameter("x"),), seven, kind=Kind.COST)
    assert bind(["pathCost@x.so"], two_rooms, attachments=[mine])["pathCost"]("a") == 7.0
