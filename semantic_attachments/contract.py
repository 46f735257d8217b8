"""What an attachment is: the one protocol between planner, world and the code that computes.

An `Attachment` is a declaration (kind, parameters, purity, quality) with a function that binds it
to a frozen `World`; what comes out is an `Evaluator`, the callable that the planner asks.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Protocol, TypeVar, runtime_checkable

from semantic_attachments.world import World

T = TypeVar("T")


class AttachmentError(Exception):
    """An attachment that fails; it stops planning and never becomes a wrong plan."""


class Kind(StrEnum):
    """Where a module call stands in an action."""

    COST = "cost"
    """A duration [s]; infinite means that the action does not apply."""
    CONDITION = "conditionchecker"
    """A condition: true or false."""
    EFFECT = "effect"
    """New values of numeric fluents."""


class Purity(StrEnum):
    """What a value depends on, beside the frozen world."""

    ARGUMENTS = "arguments"
    """The arguments only: computed once for each tuple of them."""
    FLUENTS = "fluents"
    """The arguments and the values of the fluents in `Attachment.reads`."""
    STATE = "state"
    """The whole state: never kept."""


class Quality(StrEnum):
    """How a cost relates to the true one; heuristics rely on it."""

    EXACT = "exact"
    LOWER_BOUND = "lower bound"
    APPROXIMATE = "approximate"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter and its PDDL type."""

    name: str
    type: str = "object"


@runtime_checkable
class Evaluator(Protocol):
    """An attachment bound to a world: a single form and a batch form of the same function."""

    def __call__(self, *arguments: str) -> float:
        """The value of one call, arguments being names of objects."""
        ...

    def many(self, calls: Sequence[tuple[str, ...]]) -> Sequence[float]:
        """The values of many calls, in their order."""
        ...


class Memory:
    """What attachments keep between the problems of one mission.

    Each attachment stores its own state under its own key and decides what a changed world leaves
    valid. Hold one for a mission and pass it to every `bind`.
    """

    def __init__(self) -> None:
        self._kept: dict[str, Any] = {}

    def get(self, key: str, kind: type[T]) -> T | None:
        """What was kept under a key, if it is of the kind asked for."""
        kept = self._kept.get(key)
        return kept if isinstance(kept, kind) else None

    def keep(self, key: str, value: object) -> None:
        """Keeps a value until the next problem."""
        self._kept[key] = value


@dataclass(frozen=True, slots=True)
class Attachment:
    """The declaration of an attachment."""

    name: str
    """The module's name in PDDL/M; case does not matter."""
    parameters: tuple[Parameter, ...]
    """Its parameters with their PDDL types."""
    bind: Callable[[World, Memory], Evaluator]
    """Binds it to a world; `Memory` is that of the mission."""
    kind: Kind = Kind.COST
    purity: Purity = Purity.ARGUMENTS
    quality: Quality = Quality.EXACT
    reads: tuple[str, ...] = ()
    """Names of the numeric fluents and predicates a value depends on, for `Purity.FLUENTS`."""
    thread_safe: bool = False
    """Whether two threads may ask one evaluator at once."""
