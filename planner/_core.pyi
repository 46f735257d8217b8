"""The native core; the façade in `planner` documents what it does."""

from collections.abc import Mapping, Sequence
from typing import Literal, final

__version__: str

StepTuple = tuple[float, str, list[str], float | None]

class Panic(Exception):  # noqa: N818 the word for it in Rust
    """The core contradicted itself."""

@final
class Diagnostic:
    """One finding about a file: what, where, how to mend it."""

    @property
    def code(self) -> str:
        """Stable code, `PDDL021`."""
    @property
    def severity(self) -> Literal["error", "warning", "information"]: ...
    @property
    def message(self) -> str:
        """One line."""
    @property
    def file(self) -> str: ...
    @property
    def line(self) -> int:
        """First line, from 1."""
    @property
    def column(self) -> int:
        """First column in characters, from 1."""
    @property
    def end_line(self) -> int: ...
    @property
    def end_column(self) -> int:
        """Column behind the end, from 1."""
    @property
    def remedy(self) -> str | None:
        """How to mend it."""
    @property
    def rendered(self) -> str:
        """The finding with the line concerned and a caret under the fault."""

@final
class Module:
    """An entry of `(:modules ...)`."""

    @property
    def name(self) -> str:
        """The name used between square brackets."""
    @property
    def kind(self) -> Literal["cost", "conditionchecker", "effect"]: ...
    @property
    def call(self) -> str:
        """The provider as written: `pathCost@libgrid.so`."""
    @property
    def parameters(self) -> list[tuple[str, list[str]]]:
        """Names and types."""

@final
class Domain:
    """A domain: read once, used for many problems."""

    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def actions(self) -> list[str]: ...
    @property
    def requirements(self) -> list[str]: ...
    @property
    def types(self) -> dict[str, list[str]]:
        """Types and their direct supertypes."""
    @property
    def modules(self) -> list[Module]: ...

@final
class Problem:
    """A problem, read against its domain."""

    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def domain(self) -> Domain: ...
    @property
    def objects(self) -> dict[str, list[str]]:
        """Objects, the domain's constants first, and the names of their types."""
    @property
    def fluents(self) -> dict[tuple[str, ...], float]:
        """Values of numeric fluents at time 0: `{("x", "target_1"): 12.5}`."""
    @property
    def facts(self) -> set[tuple[str, ...]]:
        """Facts true at time 0: `{("at", "e1", "a")}`."""
    @property
    def module_options(self) -> list[tuple[str, list[str]]]:
        """`(:moduleoptions ...)`: calls and their arguments as written."""

@final
class State:
    """A read-only view of the state in which an attachment is called; useless after the call."""

    def holds(self, predicate: str, *arguments: str) -> bool:
        """Whether a fact holds."""
    def value(self, function: str, *arguments: str) -> float | None:
        """The value of a numeric fluent; None where it is undefined."""

@final
class Verdict:
    @property
    def valid(self) -> bool: ...
    @property
    def makespan(self) -> float: ...
    @property
    def metric(self) -> float | None: ...
    @property
    def reason(self) -> str | None: ...
    @property
    def message(self) -> str | None: ...
    @property
    def time(self) -> float | None: ...
    @property
    def happening(self) -> int | None: ...
    @property
    def step(self) -> int | None: ...
    @property
    def facts(self) -> list[str]: ...
    @property
    def report(self) -> list[str]: ...
    @property
    def attachment(self) -> tuple[str, list[str], str, str] | None:
        """The attachment that failed: module, arguments, action, reason."""

@final
class Report:
    @property
    def outcome(self) -> str: ...
    @property
    def limit(self) -> str | None: ...
    @property
    def lower_bound(self) -> float: ...
    @property
    def expansions(self) -> int: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def schedules(self) -> int: ...
    @property
    def operators(self) -> int: ...
    @property
    def facts(self) -> int: ...
    @property
    def grounding_s(self) -> float: ...

@final
class Event:
    @property
    def plan(self) -> tuple[list[StepTuple], float | None, float] | None:
        """An improving plan: steps, value of the metric, seconds since the call."""
    @property
    def report(self) -> Report | None:
        """The end of the search."""
    @property
    def attachment(self) -> tuple[str, list[str], str, str] | None:
        """The attachment that failed: module, arguments, action, reason."""
    @property
    def exception(self) -> BaseException | None: ...
    @property
    def refused(self) -> str | None:
        """Why the problem cannot be planned with."""
    @property
    def internal(self) -> str | None:
        """A fault of the planner."""

@final
class Search:
    """A search in a thread of its own."""

    def __new__(
        cls,
        problem: Problem,
        attachments: Mapping[str, object],
        *,
        timeout_s: float | None,
        cpu_timeout_s: float | None,
        seed: int,
        threads: int,
        node_limit: int | None,
        memory_limit: int | None,
        first_plan_only: bool,
        warm_start: Sequence[StepTuple] | None,
        heuristic: str | None,
        space: str,
        promptness: float,
    ) -> Search: ...
    def next(self, timeout_s: float) -> Event | None:
        """The next event; None if there was none for that long."""
    def progress(self) -> tuple[int, float]:
        """States expanded and plans built so far, and the lower bound."""
    def cancel(self) -> None:
        """Asks it to stop; its end is told within 50 ms, unless an attachment takes longer."""

def read_domain(text: bytes, name: str) -> tuple[Domain | None, list[Diagnostic]]: ...
def read_problem(
    domain: Domain, text: bytes, name: str
) -> tuple[Problem | None, list[Diagnostic]]: ...
def read_plan(
    problem: Problem, text: bytes, name: str
) -> tuple[list[StepTuple] | None, list[Diagnostic]]: ...
def write_plan(
    steps: Sequence[StepTuple],
    *,
    domain: str | None = None,
    problem: str | None = None,
    evaluated: int | None = None,
    metric: float | None = None,
) -> str: ...
def validate(
    problem: Problem,
    steps: Sequence[StepTuple],
    attachments: Mapping[str, object],
    tolerance_s: float,
    separation_s: float,
    report: bool,
) -> tuple[Verdict, BaseException | None]: ...

Range = tuple[int, int, int, int]
"""First line and column, last line and column behind the end; from 0, in UTF-16 units."""
File = tuple[str, bytes]

@final
class Finding:
    """One finding with everything an editor can show."""

    @property
    def code(self) -> str: ...
    @property
    def severity(self) -> Literal["error", "warning", "information"]: ...
    @property
    def message(self) -> str: ...
    @property
    def label(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def range(self) -> Range: ...
    @property
    def notes(self) -> list[tuple[str, Range, str]]: ...
    @property
    def remedy(self) -> str | None: ...
    @property
    def fix(self) -> tuple[str, list[tuple[Range, str]]] | None: ...
    @property
    def rendered(self) -> str: ...

@final
class Mention:
    """A name somewhere in a file."""

    @property
    def kind(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def range(self) -> Range: ...
    @property
    def definition(self) -> bool: ...
    @property
    def scope(self) -> int: ...
    @property
    def declaration(self) -> Range | None: ...
    @property
    def declaration_text(self) -> str | None: ...

def check_files(
    domain: File, problems: Sequence[File], providers: Sequence[str] | None
) -> list[list[Finding]]: ...
def format_file(file: File) -> tuple[str | None, list[Finding]]: ...
def codes() -> list[tuple[str, str, str, str, str, str]]: ...
def parse_code(text: str) -> str | None: ...
def definition_of(text: str) -> tuple[Literal["domain", "problem"], str, str | None] | None: ...
def mentions(domain: str | None, problem: str | None) -> list[Mention]: ...
def completions(
    text: str, line: int, column: int, domain: str | None
) -> list[tuple[str, str, str]]: ...
def panic_on_purpose(message: str) -> None: ...
