"""Names in a family of documents: what stands at a place, where it is declared and used."""

from collections.abc import Iterator
from dataclasses import dataclass

from planner import _core
from planner._core import Mention
from planner.language_server.documents import Document, Family

GLOBAL = "domain"
"""Home of names that a domain declares."""


@dataclass(frozen=True)
class Symbol:
    """What a name stands for; `home` is the file that declares it, or `GLOBAL`."""

    kind: str
    name: str
    scope: int
    home: str


@dataclass(frozen=True)
class Located:
    """A mention and the document that it stands in."""

    document: Document
    mention: Mention
    symbol: Symbol


def located(documents: Family) -> list[Located]:
    """All mentions in a family, document by document."""
    domain = documents.domain
    text = None if domain is None else domain.text
    found = [
        (document, _core.mentions(text, None if document is domain else document.text))
        for document in documents.documents
    ]
    constants = {
        mention.name
        for document, mentions in found
        for mention in mentions
        if document is domain and mention.kind == "object" and mention.definition
    }
    return [
        Located(document, mention, _symbol(document, mention, constants))
        for document, mentions in found
        for mention in mentions
    ]


def _symbol(document: Document, mention: Mention, constants: set[str]) -> Symbol:
    local = mention.kind in {"variable", "problem"} or (
        mention.kind == "object" and mention.name not in constants
    )
    home = str(document.path) if local else GLOBAL
    return Symbol(mention.kind, mention.name, mention.scope, home)


def at(found: list[Located], document: Document, line: int, column: int) -> Located | None:
    """The mention that a place touches."""
    for one in found:
        first, start, last, end = one.mention.range
        here = one.document.path == document.path and first <= line <= last
        if here and (first, start) <= (line, column) <= (last, end):
            return one
    return None


def same(found: list[Located], symbol: Symbol) -> Iterator[Located]:
    """All mentions of a symbol."""
    return (one for one in found if one.symbol == symbol)


def definition(found: list[Located], symbol: Symbol) -> Located | None:
    """The first declaration of a symbol."""
    return next((one for one in same(found, symbol) if one.mention.definition), None)


def described(found: list[Located], symbol: Symbol) -> str:
    """Markdown for a hover: the declaration, its comment, where the name is used."""
    declared = definition(found, symbol)
    uses = [one for one in same(found, symbol) if not one.mention.definition]
    lines = [f"```pddl\n{_declaration(declared, symbol)}\n```"]
    if declared is not None:
        comment = _comment(declared)
        if comment:
            lines.append(comment)
    lines.append(f"*{symbol.kind}*, {_uses(uses)}")
    return "\n\n".join(lines)


def _uses(uses: list[Located]) -> str:
    if not uses:
        return "never used"
    places: dict[str, list[str]] = {}
    for one in uses:
        lines = places.setdefault(one.document.path.name, [])
        line = str(one.mention.range[0] + 1)
        if line not in lines:
            lines.append(line)
    shown = (
        f"{name}:{', '.join(lines[:8])}{' ...' if len(lines) > 8 else ''}"
        for name, lines in list(places.items())[:5]
    )
    times = "once" if len(uses) == 1 else f"{len(uses)} times"
    return f"used {times}: {'; '.join(shown)}"


def _declaration(declared: Located | None, symbol: Symbol) -> str:
    if declared is None or declared.mention.declaration_text is None:
        return symbol.name
    text = declared.mention.declaration_text
    if symbol.kind == "action":
        return _head(text)
    if symbol.kind in {"type", "object", "variable"}:
        name, dash, types = text.rpartition(" - ")
        shown = declared.mention.text
        return f"{shown} - {types.strip()}" if dash and name else f"{shown} - object"
    return " ".join(text.split())


def _head(action: str) -> str:
    """An action up to the end of its parameters."""
    start = action.lower().find(":parameters")
    if start < 0:
        return action.splitlines()[0]
    end = action.find(")", start)
    return " ".join(action[: end + 1].split())


def _comment(declared: Located) -> str:
    """The comment behind a declaration, or the lines of comment above it."""
    lines = declared.document.text.splitlines()
    place = declared.mention.declaration
    if place is None or place[0] >= len(lines):
        return ""
    if place[2] < len(lines) and ";" in lines[place[2]]:
        return lines[place[2]].partition(";")[2].strip(" ;")
    above: list[str] = []
    for line in reversed(lines[: place[0]]):
        if not line.lstrip().startswith(";"):
            break
        above.append(line.strip(" ;\t"))
    return " ".join(reversed(above))
