"""What an attachment is: the one protocol between planner, world and the code that computes.

An `Attachment` declares (kind, parameters, purity, quality) and binds a function to a frozen
`World`; what comes out is what the planner asks: a callable, best with a batch form `many`.

| kind | purity | asked as | answers |
|---|---|---|---|
| cost | arguments | `f(*arguments)`, `f.many(calls)` | seconds; infinite: not applicable |
| cost | fluents, state | `f(state, *arguments)`, `f.many(calls, state)` | seconds |
| condition | as cost | as cost | `bool` |
| effect | any | `f(state, *arguments)` | new values of the fluents written, or None |

Arguments are names of objects. Modules that ground new objects are not supported.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Protocol, TypeVar, runtime_checkable

from semantic_attachments.world import World

T = TypeVar("T")


class EvaluationError(Exception):
    """An evaluation that failed; the planner turns it into its `AttachmentError` and stops.

    `position` is the number of the call in its batch.
    """

    def __init__(self, reason: str, position: int = 0) -> None:
        super().__init__(reason)
        self.position = position


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
    """The arguments and what `Attachment.reads` names; remembered by these values."""
    STATE = "state"
    """The whole state: never remembered here."""


class Quality(StrEnum):
    """How a cost relates to the true one: what a search can prove with it (`planner.proofs`)."""

    EXACT = "exact"
    LOWER_BOUND = "lower bound"
    """Never above the true cost, so that a plan that avoids it need not know better."""
    APPROXIMATE = "approximate"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter and its PDDL type."""

    name: str
    type: str = "object"


class StateView(Protocol):
    """The planner's state, read-only, while an attachment is asked."""

    def holds(self, predicate: str, *arguments: str) -> bool:
        """Whether a fact holds."""
        ...

    def value(self, function: str, *arguments: str) -> float | None:
        """The value of a numeric fluent, None where it is undefined."""
        ...


@runtime_checkable
class Evaluator(Protocol):
    """A bound cost that depends on its arguments: a single form and a batch form."""

    def __call__(self, *arguments: str) -> float:
        """The value of one call."""
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
    bind: Callable[[World, Memory], Callable[..., Any]]
    """Binds it to a world; `Memory` is that of the mission. See the table above for the result."""
    kind: Kind = Kind.COST
    purity: Purity = Purity.ARGUMENTS
    quality: Quality = Quality.EXACT
    reads: tuple[tuple[str, ...], ...] = ()
    """For `Purity.FLUENTS`: fluents and predicates, each with names of parameters as arguments,
    such as `("energy", "robot")`."""
    thread_safe: bool = False
    """Whether two threads may ask it at once; if not, they wait for one another."""
    quick: bool = False
    """Whether it always answers soon, by a look at a table or a search of the map: then it is asked
    in the planner's own thread, and no time limit is watched."""

    def __post_init__(self) -> None:
        names = {parameter.name for parameter in self.parameters}
        for symbol, *arguments in self.reads:
            if unknown := [name for name in arguments if name not in names]:
                raise ValueError(
                    f"attachment {self.name}: ({symbol} ...) reads {unknown[0]!r}, no parameter"
                )
        if bool(self.reads) != (self.purity is Purity.FLUENTS):
            raise ValueError(
                f"attachment {self.name}: `reads` names fluents if and only if purity is FLUENTS"
            )
