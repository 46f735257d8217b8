"""Finding attachments and binding them."""

import math
import subprocess
import sys
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import EntryPoint

import pytest

from semantic_attachments import Attachment, BindingError, Memory, World, bind, registry
from semantic_attachments.contract import Evaluator, Kind, Parameter
from semantic_attachments.grid import Single
from semantic_attachments.registry import GROUP, OWN, installed, resolve

WAY = (Parameter("robot"), Parameter("from"), Parameter("to"))
FLY = Attachment("flyCost", WAY, lambda _, __: Single(lambda *_: 1.0))
TAKEN = Attachment("pathCost", WAY, lambda _, __: Single(lambda *_: 1.0))


def test_what_is_installed_is_complete() -> None:
    for name, attachment in installed().items():
        assert name == attachment.name.lower()
        assert attachment.parameters
        assert len({parameter.name for parameter in attachment.parameters}) == len(
            attachment.parameters
        )
        assert attachment.bind.__doc__ is not None or attachment.bind.__name__.startswith("_")


def test_the_table_of_own_attachments_is_complete() -> None:
    declared = {
        attachment.name.lower(): module
        for module in set(OWN.values())
        for attachment in import_module(f"semantic_attachments.{module}").ATTACHMENTS
    }
    assert declared == OWN


def test_only_the_module_of_the_attachment_asked_for_is_imported() -> None:
    program = (
        "import sys; from semantic_attachments.registry import resolve; "
        "resolve('pathCost@libgrid.so'); "
        "print([m for m in ('semantic_attachments.motion', 'semantic_attachments.battery') "
        "if m in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == "[]"


def test_attachments_of_other_packages_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """By entry point; one that declares a name of this package is refused."""
    points = {EntryPoint("fly", "tests.semantic_attachments.test_registry:FLY", GROUP)}
    monkeypatch.setattr(registry, "_entry_points", lambda: points)
    installed.cache_clear()
    try:
        assert resolve("flyCost@libfly.so") is FLY
        assert resolve("pathCost").name == "pathCost"
        points.add(EntryPoint("mine", "tests.semantic_attachments.test_registry:TAKEN", GROUP))
        installed.cache_clear()
        with pytest.raises(BindingError, match="pathCost is declared by both marsupial and tests"):
            resolve("unknown")
    finally:
        installed.cache_clear()


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
