"""Replaces attachments by their values: plain PDDL 2.1 for planners that know no modules.

A cost module `[pathCost ?r ?a ?b]` becomes the numeric fluent `(pathcost ?r ?a ?b)`, a condition
checker `[chk ?a]` the static predicate `(chk ?a)`. Where a cost is infinite, the fluent has no
value and the predicate `(finite-pathcost ?r ?a ?b)` keeps the action from applying.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import product
from math import isfinite

from planner._core import Domain, Module, Problem
from planner.attachments import Attachments, attachment_error
from planner.reading import read_domain, read_problem
from planner.s_expressions import Call, Expression, parse, write
from planner.solving import UnsupportedError

MOST_TUPLES = 2_000_000


@dataclass(frozen=True, slots=True)
class Compiled:
    """Plain PDDL 2.1."""

    domain: str
    problem: str

    def read(self) -> Problem:
        """The problem, read again."""
        return read_problem(read_domain(self.domain), self.problem)


@dataclass
class Table:
    """The values of a module."""

    module: Module
    name: str
    guard: str | None = None
    init: list[Expression] = field(default_factory=list)


def compile_attachments(problem: Problem, attachments: Attachments) -> Compiled:
    """A domain and problem without modules that have the same plans.

    Raises `UnsupportedError` for effects and for modules whose value depends on the state,
    `AttachmentError` for an attachment that is missing or fails.
    """
    tables = {
        module.name.lower(): _tabulate(module, problem, attachments)
        for module in problem.domain.modules
    }
    if not tables:
        return Compiled(problem.domain.text, problem.text)
    domain = _rewrite_domain(parse(problem.domain.text), tables)
    definition = parse(problem.text)
    for section in definition:
        if _head(section) == ":init":
            assert isinstance(section, list)
            for table in tables.values():
                section.extend(table.init)
    kept: list[Expression] = [
        section
        for section in definition
        if _head(section) not in {":moduleoptions", ":moduleexitoptions"}
    ]
    return Compiled(write(domain) + "\n", write(kept) + "\n")


def members(problem: Problem, types: Iterable[str]) -> list[str]:
    """The objects of any of these types, in the order of declaration."""
    parents = problem.domain.types
    wanted = set(types) or {"object"}

    def belongs(type_name: str) -> bool:
        return type_name in wanted or any(belongs(parent) for parent in parents.get(type_name, ()))

    return [
        name
        for name, own in problem.objects.items()
        if "object" in wanted or any(belongs(one) for one in own)
    ]


def _tabulate(module: Module, problem: Problem, attachments: Attachments) -> Table:
    """Evaluates a module for all arguments of its parameters' types."""
    attachment = next((a for n, a in attachments.items() if n.lower() == module.name.lower()), None)
    if module.kind == "effect":
        raise UnsupportedError(f"the effect module [{module.name}] cannot be compiled away")
    if str(getattr(attachment, "purity", "arguments")) != "arguments":
        raise UnsupportedError(
            f"the value of [{module.name}] depends on the state and cannot be compiled away"
        )
    if attachment is None:
        raise attachment_error(
            (module.name, [], "(all)", "no provider was given for this module"), None
        )
    domains = [members(problem, types) for _, types in module.parameters]
    calls = list(product(*domains))
    if len(calls) > MOST_TUPLES:
        raise UnsupportedError(f"[{module.name}] has {len(calls)} argument tuples, too many")
    try:
        many = getattr(attachment, "many", None)
        values = (
            [float(value) for value in many(calls)]
            if many is not None
            else [float(attachment(*call)) for call in calls]  # type: ignore[operator]
        )
    except Exception as error:
        raise attachment_error((module.name, [], "(all)", str(error)), error) from error
    return _table(module, problem.domain, calls, values)


def _table(
    module: Module, domain: Domain, calls: list[tuple[str, ...]], values: list[float]
) -> Table:
    taken = {str(word).lower() for word in _words(parse(domain.text))}
    name = module.name.lower()
    table = Table(module, name)
    if module.kind == "conditionchecker":
        table.init = [[name, *call] for call, v in zip(calls, values, strict=True) if _true(v)]
        return table
    if not all(map(isfinite, values)):
        table.guard = f"finite-{name}"
        while table.guard in taken:
            table.guard += "-"
    for call, value in zip(calls, values, strict=True):
        if isfinite(value):
            table.init.append(["=", [name, *call], decimal(value)])
            if table.guard is not None:
                table.init.append([table.guard, *call])
    return table


def _true(value: float) -> bool:
    return value != 0 and isfinite(value)


def decimal(value: float) -> str:
    """A number that reads back as the same number, without exponent."""
    return format(Decimal(repr(float(value))), "f")


def _rewrite_domain(definition: list[Expression], tables: dict[str, Table]) -> list[Expression]:
    """Declares fluents and predicates, drops the modules, replaces their calls."""
    sections = [
        _rewrite_action(section, tables)
        if _head(section) in {":action", ":durative-action"}
        else _plain(section, tables, None)
        for section in definition
        if _head(section) not in {":modules", ":oplinit"}
    ]
    functions: list[Expression] = []
    predicates: list[Expression] = []
    for table in tables.values():
        parameters = list(_typed(table.module))
        if table.module.kind == "cost":
            functions.append([table.name, *parameters])
        else:
            predicates.append([table.name, *parameters])
        if table.guard is not None:
            predicates.append([table.guard, *parameters])
    _declare(sections, ":functions", functions)
    _declare(sections, ":predicates", predicates)
    _declare(sections, ":requirements", [":numeric-fluents"] if functions else [])
    return sections


def _declare(sections: list[Expression], head: str, declarations: list[Expression]) -> None:
    """Adds to a section, which is made behind the types where there is none."""
    if not declarations:
        return
    for section in sections:
        if _head(section) == head:
            assert isinstance(section, list)
            section.extend(one for one in declarations if one not in section)
            return
    place = 2
    for index, section in enumerate(sections):
        if _head(section) in {":requirements", ":types", ":constants", ":predicates"}:
            place = index + 1
    sections.insert(2 if head == ":requirements" else place, [head, *declarations])


def _typed(module: Module) -> Iterator[Expression]:
    for name, types in module.parameters:
        yield name
        yield "-"
        yield types[0] if len(types) == 1 else ["either", *types]


def _rewrite_action(section: Expression, tables: dict[str, Table]) -> Expression:
    """Replaces calls and adds the guards of those whose value may be infinite."""
    assert isinstance(section, list)
    guards: list[Expression] = []
    rewritten = _plain(section, tables, guards)
    assert isinstance(rewritten, list)
    unique = [guard for index, guard in enumerate(guards) if guard not in guards[:index]]
    if not unique:
        return rewritten
    durative = _head(section) == ":durative-action"
    parameters = _value_of(rewritten, ":parameters")
    for guard in unique:
        free = [word for word in guard if isinstance(word, str) and word.startswith("?")]
        if isinstance(parameters, list) and not all(word in parameters for word in free):
            raise UnsupportedError(f"{write(guard)} would stand inside a quantifier")
    added: list[Expression] = [["at", "start", one] if durative else one for one in unique]
    key = ":condition" if durative else ":precondition"
    old = _value_of(rewritten, key)
    new: list[Expression] = ["and", *added, *([old] if old else [])]
    if old is None:
        position = _position(rewritten, ":effect")
        rewritten[position:position] = [key, new]
    else:
        rewritten[_position(rewritten, key) + 1] = new
    return rewritten


def _plain(
    expression: Expression, tables: dict[str, Table], guards: list[Expression] | None
) -> Expression:
    """A copy with every call replaced; guards of the calls are collected."""
    if isinstance(expression, str):
        return expression
    parts = [_plain(part, tables, guards) for part in expression]
    # A condition checker may stand in parentheses of its own: ([chk ?a]).
    if len(parts) == 1 and not isinstance(expression, Call) and isinstance(expression[0], Call):
        return parts[0]
    if not isinstance(expression, Call):
        return parts
    table = tables[str(parts[0]).lower()]
    if table.guard is not None and guards is not None:
        guards.append([table.guard, *parts[1:]])
    return [table.name, *parts[1:]]


def _head(expression: Expression) -> str:
    """The lower-case first word of a list."""
    if isinstance(expression, list) and expression and isinstance(expression[0], str):
        return expression[0].lower()
    return ""


def _position(action: list[Expression], key: str) -> int:
    """Where a key of an action stands; its end where it does not."""
    for index, part in enumerate(action):
        if isinstance(part, str) and part.lower() == key:
            return index
    return len(action)


def _value_of(action: list[Expression], key: str) -> Expression | None:
    position = _position(action, key)
    return action[position + 1] if position + 1 < len(action) else None


def _words(expression: Expression) -> Iterator[str]:
    if isinstance(expression, str):
        yield expression
    else:
        for part in expression:
            yield from _words(part)
