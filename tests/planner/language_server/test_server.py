"""A session of a real language client over stdio."""

import asyncio
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import pytest_asyncio
from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

ROOT = Path(__file__).parents[3]
DOMAIN = """\
(define (domain d)
  (:requirements :typing)
  (:types robot place - object)
  (:constants home - place)
  (:predicates
    (at ?r - robot ?p - place) ; where it is, 𝕏
    (free ?p - place))
  (:modules
    (pathCost ?r - robot cost path@world))
  (:action go
    :parameters (?r - robot ?from ?to - place)
    :precondition (and (at ?r ?from) (not (at ?r ?to)) (free ?to))
    :effect (and (at ?r ?to) (not (at ?r ?from)))))
"""
PROBLEM = """\
(define (problem p)
  (:domain d)
  (:objects r1 - robot kitchen - place)
  (:init (at r1 home) (free kitchen))
  (:goal (at r1 kitchn)))
"""


class Session:
    """A client, a server and the documents that the client has open."""

    def __init__(self, client: LanguageClient, folder: Path) -> None:
        self.client = client
        self.folder = folder
        self.versions: dict[str, int] = {}
        self.published: dict[str, asyncio.Queue[list[types.Diagnostic]]] = {}

    def uri(self, name: str) -> str:
        return (self.folder / name).as_uri()

    def queue(self, uri: str) -> "asyncio.Queue[list[types.Diagnostic]]":
        return self.published.setdefault(uri, asyncio.Queue())

    async def opened(self, name: str, text: str) -> list[types.Diagnostic]:
        uri = self.uri(name)
        self.versions[uri] = 1
        self.client.text_document_did_open(
            types.DidOpenTextDocumentParams(types.TextDocumentItem(uri, "pddl", 1, text))
        )
        return await self.diagnostics(name)

    async def changed(self, name: str, text: str) -> list[types.Diagnostic]:
        uri = self.uri(name)
        self.versions[uri] += 1
        self.client.text_document_did_change(
            types.DidChangeTextDocumentParams(
                types.VersionedTextDocumentIdentifier(self.versions[uri], uri),
                [types.TextDocumentContentChangeWholeDocument(text)],
            )
        )
        return await self.diagnostics(name)

    async def diagnostics(self, name: str) -> list[types.Diagnostic]:
        return await asyncio.wait_for(self.queue(self.uri(name)).get(), timeout=20)

    def identifier(self, name: str) -> types.TextDocumentIdentifier:
        return types.TextDocumentIdentifier(self.uri(name))


def place(text: str, needle: str, more: int = 0) -> types.Position:
    """Where `needle` begins, in UTF-16 columns."""
    before = text[: text.index(needle) + more]
    line = before.rpartition("\n")[2]
    return types.Position(before.count("\n"), len(line.encode("utf-16-le")) // 2)


def edited(text: str, edits: list[types.TextEdit]) -> str:
    """A text after edits; columns are UTF-16 units."""
    lines = text.splitlines(keepends=True)

    def offset(position: types.Position) -> int:
        start = sum(map(len, lines[: position.line]))
        line = lines[position.line] if position.line < len(lines) else ""
        units = line.encode("utf-16-le")[: 2 * position.character]
        return start + len(units.decode("utf-16-le"))

    for edit in sorted(edits, key=lambda one: offset(one.range.start), reverse=True):
        text = text[: offset(edit.range.start)] + edit.new_text + text[offset(edit.range.end) :]
    return text


@pytest_asyncio.fixture
async def session(tmp_path: Path) -> AsyncIterator[Session]:
    client = LanguageClient("test", "1")
    session = Session(client, tmp_path)

    @client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    def published(_: LanguageClient, params: types.PublishDiagnosticsParams) -> None:
        session.queue(params.uri).put_nowait(list(params.diagnostics))

    await client.start_io(sys.executable, "-m", "planner.language_server", cwd=str(ROOT))
    await client.initialize_async(
        types.InitializeParams(
            capabilities=types.ClientCapabilities(
                general=types.GeneralClientCapabilities(position_encodings=["utf-8", "utf-16"])
            ),
            root_uri=tmp_path.as_uri(),
        )
    )
    client.initialized(types.InitializedParams())
    yield session
    await client.shutdown_async(None)
    client.exit(None)
    await client.stop()


@pytest.mark.asyncio
async def test_diagnostics_as_you_type_and_quick_fixes(session: Session) -> None:
    found = await session.opened("domain.pddl", DOMAIN)
    assert [one.code for one in found if one.code == "PDDL060"] == ["PDDL060"]
    missing = next(one for one in found if one.code == "PDDL060")
    actions = await session.client.text_document_code_action_async(
        types.CodeActionParams(
            session.identifier("domain.pddl"), missing.range, types.CodeActionContext([missing])
        )
    )
    assert actions is not None
    (action,) = [one for one in actions if isinstance(one, types.CodeAction)]
    assert action.title == "Add `:negative-preconditions`"
    assert action.edit is not None
    assert action.edit.changes is not None
    mended = edited(DOMAIN, list(action.edit.changes[session.uri("domain.pddl")]))
    found = await session.changed("domain.pddl", mended)
    assert "PDDL060" not in {one.code for one in found}

    found = await session.opened("problem.pddl", PROBLEM)
    (unknown,) = [one for one in found if one.severity == types.DiagnosticSeverity.Error]
    assert unknown.code == "PDDL023"
    assert unknown.range.start == place(PROBLEM, "kitchn")
    found = await session.changed("problem.pddl", PROBLEM.replace("kitchn", "kitchen"))
    assert not [one for one in found if one.severity == types.DiagnosticSeverity.Error]


@pytest.mark.asyncio
async def test_hover_definition_and_references_cross_files(session: Session) -> None:
    await session.opened("domain.pddl", DOMAIN)
    await session.opened("problem.pddl", PROBLEM)
    client, problem = session.client, session.identifier("problem.pddl")
    here = place(PROBLEM, "at r1")
    hover = await client.text_document_hover_async(types.HoverParams(problem, here))
    assert hover is not None
    assert isinstance(hover.contents, types.MarkupContent)
    assert "(at ?r - robot ?p - place)" in hover.contents.value
    assert "where it is" in hover.contents.value
    assert "used 6 times" in hover.contents.value

    target = await client.text_document_definition_async(types.DefinitionParams(problem, here))
    assert isinstance(target, types.Location)
    assert target.uri == session.uri("domain.pddl")
    assert target.range.start == place(DOMAIN, "at ?r - robot")

    context = types.ReferenceContext(include_declaration=False)
    used = await client.text_document_references_async(
        types.ReferenceParams(context, problem, here)
    )
    assert used is not None
    assert len(used) == 6
    assert {one.uri for one in used} == {session.uri("domain.pddl"), session.uri("problem.pddl")}


@pytest.mark.asyncio
async def test_rename_changes_every_file_and_refuses_taken_names(session: Session) -> None:
    # The problem is not open: it is found beside the domain.
    (session.folder / "problem.pddl").write_text(PROBLEM)
    await session.opened("domain.pddl", DOMAIN)
    client, domain = session.client, session.identifier("domain.pddl")
    here = place(DOMAIN, "free ?p")
    edit = await client.text_document_rename_async(types.RenameParams(domain, here, "vacant"))
    assert edit is not None
    assert edit.changes is not None
    renamed = edited(DOMAIN, list(edit.changes[session.uri("domain.pddl")]))
    assert renamed == DOMAIN.replace("(free", "(vacant")
    renamed = edited(PROBLEM, list(edit.changes[session.uri("problem.pddl")]))
    assert renamed == PROBLEM.replace("(free", "(vacant")

    variable = place(DOMAIN, "?from")
    edit = await client.text_document_rename_async(types.RenameParams(domain, variable, "start"))
    assert edit is not None
    assert edit.changes is not None
    renamed = edited(DOMAIN, list(edit.changes[session.uri("domain.pddl")]))
    assert renamed == DOMAIN.replace("?from", "?start")

    for bad in ["at", "1x", "a b"]:
        with pytest.raises(JsonRpcException):
            await client.text_document_rename_async(types.RenameParams(domain, here, bad))


@pytest.mark.asyncio
async def test_completion_symbols_and_formatting(session: Session) -> None:
    await session.opened("domain.pddl", DOMAIN)
    client, domain = session.client, session.identifier("domain.pddl")

    async def offered(position: types.Position) -> set[str]:
        items = await client.text_document_completion_async(
            types.CompletionParams(domain, position)
        )
        assert isinstance(items, list)
        return {item.label for item in items}

    assert await offered(place(DOMAIN, "robot ?from")) == {"object", "robot", "place"}
    assert {"?r", "?from", "?to", "home"} <= await offered(place(DOMAIN, "?from) (not"))
    assert {"at", "free", "and", "not"} <= await offered(place(DOMAIN, "at ?r ?from"))
    with_call = DOMAIN.replace("(free ?to))", "[p])")
    await session.changed("domain.pddl", with_call)
    assert await offered(place(with_call, "[p])", 2)) == {"pathCost"}

    symbols = await client.text_document_document_symbol_async(types.DocumentSymbolParams(domain))
    assert symbols is not None
    assert {"d", "robot", "home", "at", "pathCost", "go"} <= {one.name for one in symbols}

    shouted = DOMAIN.replace("home", "Home").replace("?from ?to - place", "?From ?to - place")
    await session.changed("domain.pddl", shouted)
    assert {"?r", "?From", "Home"} <= await offered(place(shouted, "?from) (not"))
    constant = place(shouted, "Home")
    hover = await client.text_document_hover_async(types.HoverParams(domain, constant))
    assert hover is not None
    assert isinstance(hover.contents, types.MarkupContent)
    assert "Home - place" in hover.contents.value

    ugly = DOMAIN.replace("\n  (:types", "    (:types")
    await session.changed("domain.pddl", ugly)
    edits = await client.text_document_formatting_async(
        types.DocumentFormattingParams(domain, types.FormattingOptions(2, True))
    )
    assert edits is not None
    assert "\n  (:types robot place - object)\n" in edited(ugly, list(edits))


@pytest.mark.asyncio
async def test_a_problem_without_its_domain_says_so(session: Session) -> None:
    (found,) = await session.opened("problem.pddl", PROBLEM)
    assert "domain `d` was not found" in found.message
    (session.folder / "domain.pddl").write_text(DOMAIN)
    found_then = await session.changed("problem.pddl", PROBLEM + "\n")
    assert [one.code for one in found_then] == ["PDDL023"]
