"""Rewrites a problem without a hierarchy of types, for planners that know only flat ones.

An object's leaf is the type it is declared with. Every predicate, function and action becomes one
for each combination of the leaves that its parameters may have; quantifiers run over the leaves.
Only the names change, so each plan of the result is one of the original.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import product

from planner._core import Problem
from planner.compile_attachments import Compiled, members
from planner.s_expressions import Expression, parse, write

Scope = dict[str, str]
"""Leaf of each variable and object."""


def without_hierarchy(plain: Compiled) -> tuple[Compiled, dict[str, str]]:
    """The problem with flat types, and the original name of each of its actions."""
    return _Rewriter(plain.read()).rewritten(plain)


def typed_names(words: Iterable[Expression]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each name of a typed list with its types; none is `object`."""
    waiting: list[str] = []
    words = iter(words)
    for word in words:
        if word != "-":
            waiting.append(str(word))
            continue
        kind = next(words)
        types = tuple(map(str, kind[1:])) if isinstance(kind, list) else (str(kind),)
        yield from ((name, types) for name in waiting)
        waiting = []
    yield from ((name, ("object",)) for name in waiting)


class _Rewriter:
    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._objects: Scope = {
            name: "-or-".join(types) or "object" for name, types in problem.objects.items()
        }
        # Names of predicates and functions with the leaves of each parameter.
        self._symbols: dict[str, list[list[str]]] = {}
        self._original: dict[str, str] = {}

    def rewritten(self, plain: Compiled) -> tuple[Compiled, dict[str, str]]:
        domain = parse(plain.domain.lower())
        for section in domain:
            if isinstance(section, list) and section[0] in (":predicates", ":functions"):
                for symbol in section[1:]:
                    if isinstance(symbol, list):
                        parameters = typed_names(symbol[1:])
                        leaves = [self._leaves(types) for _, types in parameters]
                        self._symbols[str(symbol[0])] = leaves
        texts = []
        for definition in (domain, parse(plain.problem.lower())):
            sections = [new for section in definition for new in self._section(section)]
            texts.append(write(sections) + "\n")
        return Compiled(*texts), self._original

    def _leaves(self, types: tuple[str, ...]) -> list[str]:
        """Leaves of the objects of any of these types."""
        return list(dict.fromkeys(self._objects[name] for name in members(self._problem, types)))

    def _section(self, section: Expression) -> Iterator[Expression]:
        if not isinstance(section, list) or not section:
            yield section
            return
        match section[0]:
            case ":types":
                leaves = list(dict.fromkeys(self._objects.values()))
                yield [":types", *(leaf for leaf in leaves if leaf != "object")]
            case ":constants" | ":objects":
                yield [section[0], *self._declared(name for name, _ in typed_names(section[1:]))]
            case ":predicates" | ":functions":
                yield [section[0], *self._declarations(section[1:])]
            case ":action" | ":durative-action":
                yield from self._actions(section)
            case ":derived":
                head = section[1]
                assert isinstance(head, list)
                for scope in self._scopes(head[1:]):
                    yield [":derived", *self._derived(head, section[2], scope)]
            case _:
                yield [section[0], *(self._formula(part, self._objects) for part in section[1:])]

    def _declared(self, names: Iterable[str]) -> Iterator[str]:
        for name in names:
            yield from (name, "-", self._objects[name])

    def _declarations(self, symbols: list[Expression]) -> Iterator[Expression]:
        for symbol in symbols:
            if not isinstance(symbol, list):  # "- number"
                continue
            name = str(symbol[0])
            names = [parameter for parameter, _ in typed_names(symbol[1:])]
            for leaves in product(*self._symbols[name]):
                yield [self._name(name, leaves), *_typed(names, leaves)]

    def _name(self, symbol: str, leaves: tuple[str, ...]) -> str:
        """The symbol for these leaves; those that are the only ones are not mentioned."""
        several = zip(self._symbols[symbol], leaves, strict=False)
        return "--".join([symbol, *(leaf for choices, leaf in several if len(choices) > 1)])

    def _scopes(self, words: Iterable[Expression]) -> Iterator[Scope]:
        """One for each combination of leaves of the variables."""
        variables = list(typed_names(words))
        for leaves in product(*(self._leaves(types) for _, types in variables)):
            yield dict(zip((name for name, _ in variables), leaves, strict=True))

    def _derived(self, head: list[Expression], body: Expression, scope: Scope) -> list[Expression]:
        leaves = tuple(scope.values())
        name = self._name(str(head[0]), leaves)
        return [[name, *_typed(scope, leaves)], self._formula(body, {**self._objects, **scope})]

    def _actions(self, section: list[Expression]) -> Iterator[Expression]:
        name = str(section[1])
        position = section.index(":parameters") + 1
        parameters = section[position]
        assert isinstance(parameters, list)
        for number, scope in enumerate(self._scopes(parameters)):
            new = f"{name}--{number}"
            self._original[new] = name
            inner = {**self._objects, **scope}
            parts = [self._formula(part, inner) for part in section[2:]]
            parts[position - 2] = list(_typed(scope, tuple(scope.values())))
            yield [section[0], new, *parts]

    def _formula(self, formula: Expression, scope: Mapping[str, str]) -> Expression:
        if not isinstance(formula, list) or not formula:
            return formula
        head, rest = formula[0], formula[1:]
        if head in ("forall", "exists"):
            words, body = rest
            assert isinstance(words, list)
            cases: list[Expression] = []
            for inner in self._scopes(words):
                variables: list[Expression] = [*_typed(inner, tuple(inner.values()))]
                cases.append([head, variables, self._formula(body, {**scope, **inner})])
            return ["and" if head == "forall" else "or", *cases]
        if isinstance(head, str) and all(isinstance(word, str) and word in scope for word in rest):
            leaves = tuple(scope[str(word)] for word in rest)
            if head in self._symbols:
                return [self._name(head, leaves), *rest]
            if head == "=" and len(set(leaves)) > 1:
                return ["or"]
        return [self._formula(part, scope) for part in formula]


def _typed(names: Iterable[str], leaves: tuple[str, ...]) -> Iterator[str]:
    for name, leaf in zip(names, leaves, strict=True):
        yield from (name, "-", leaf)
