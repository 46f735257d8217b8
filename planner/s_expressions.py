"""PDDL as nested lists, for rewriting texts that the reader has accepted."""

from __future__ import annotations

import re
from typing import TypeAlias

Expression: TypeAlias = "str | list[Expression] | Call"

_TOKEN = re.compile(r"[()\[\]]|[^\s()\[\];]+|;[^\n]*")


class Call(list["Expression"]):
    """A module call, `[pathCost ?r ?a ?b]`."""


def parse(text: str) -> list[Expression]:
    """The definition in a text whose brackets are balanced; comments are left out."""
    stack: list[list[Expression]] = [[]]
    for token in _TOKEN.findall(text):
        if token.startswith(";"):
            continue
        if token == "(":
            stack.append([])
        elif token == "[":
            stack.append(Call())
        elif token in {")", "]"}:
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(token)
    definition = stack[0][0]
    assert isinstance(definition, list)
    return definition


def write(expression: Expression, indent: int = 0) -> str:
    """PDDL text; lists that do not fit on a line are broken at their elements."""
    if isinstance(expression, str):
        return expression
    opening, closing = ("[", "]") if isinstance(expression, Call) else ("(", ")")
    flat = opening + " ".join(write(part) for part in expression) + closing
    if len(flat) + indent <= 100 or not expression:
        return flat
    lines: list[str] = []
    for part in expression:
        text = write(part, indent + 1)
        if lines and "\n" not in text and len(lines[-1]) + len(text) + indent < 99:
            lines[-1] += " " + text
        else:
            lines.append(text)
    return opening + ("\n" + " " * (indent + 1)).join(lines) + closing
