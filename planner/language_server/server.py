"""The language server: diagnostics as you type, hover, definition, references, rename, completion,
document symbols, formatting, quick fixes.

Source: Language Server Protocol 3.17. Positions are UTF-16 whatever the client would also speak.
"""

import asyncio
import os
import re
import sys
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, lsp_method
from pygls.uris import to_fs_path

from planner import _core
from planner._core import Finding
from planner.language_server import symbols
from planner.language_server.documents import Document, Family, family
from planner.language_server.findings import (
    as_action,
    as_diagnostic,
    as_range,
    findings,
    missing_domain,
)
from planner.language_server.providers import providers_for

DEBOUNCE_S = 0.15
"""How long typing must pause before a check."""
NAME = re.compile(r"[A-Za-z][\w-]*")

COMPLETION_KINDS = {
    "keyword": types.CompletionItemKind.Keyword,
    "type": types.CompletionItemKind.Class,
    "object": types.CompletionItemKind.Constant,
    "predicate": types.CompletionItemKind.Property,
    "function": types.CompletionItemKind.Field,
    "module": types.CompletionItemKind.Function,
    "variable": types.CompletionItemKind.Variable,
    "domain": types.CompletionItemKind.Module,
}
SYMBOL_KINDS = {
    "domain": types.SymbolKind.Namespace,
    "problem": types.SymbolKind.Namespace,
    "type": types.SymbolKind.Class,
    "object": types.SymbolKind.Constant,
    "predicate": types.SymbolKind.Property,
    "function": types.SymbolKind.Field,
    "module": types.SymbolKind.Interface,
    "action": types.SymbolKind.Function,
}


class Utf16Protocol(LanguageServerProtocol):
    """Speaks UTF-16 columns, which every client has to understand."""

    @lsp_method(types.INITIALIZE)
    def lsp_initialize(
        self, params: types.InitializeParams
    ) -> Generator[Any, Any, types.InitializeResult]:
        """Answers the client's first request."""
        if params.capabilities.general is not None:
            params.capabilities.general.position_encodings = None
        return (yield from super().lsp_initialize(params))


class PddlServer(LanguageServer):
    """A server and what it knows of the open documents."""

    def __init__(self) -> None:
        super().__init__("marsupial", _core.__version__, protocol_cls=Utf16Protocol)
        self.published: dict[Path, list[Finding]] = {}
        self.pending: dict[Path, asyncio.Task[None]] = {}

    def opened(self) -> dict[Path, str]:
        """Texts of the open documents."""
        texts = self.workspace.text_documents
        return {_path(uri): document.source for uri, document in texts.items()}

    def document(self, uri: str) -> Document:
        """An open document."""
        return Document(_path(uri), self.workspace.get_text_document(uri).source)

    def family(self, uri: str) -> Family:
        """The documents that belong together with one."""
        return family(self.document(uri), self.opened())

    def uri(self, path: Path) -> str:
        """The address of a document, as the client writes it if it is open."""
        known = (uri for uri in self.workspace.text_documents if _path(uri) == path)
        return str(next(known, None) or path.absolute().as_uri())

    def schedule(self, uri: str) -> None:
        """Checks a document's family once typing pauses."""
        path = _path(uri)
        earlier = self.pending.pop(path, None)
        if earlier is not None:
            earlier.cancel()
        self.pending[path] = asyncio.get_running_loop().create_task(self._check(uri))

    async def _check(self, uri: str) -> None:
        await asyncio.sleep(DEBOUNCE_S)
        if uri not in self.workspace.text_documents:
            return
        documents = self.family(uri)
        opened = self.opened()
        text = "" if documents.domain is None else documents.domain.text
        providers = await asyncio.to_thread(providers_for, text.encode(errors="replace"))
        found = await asyncio.to_thread(findings, documents, opened, providers.names)
        for path, list_of_findings in found.items():
            # Meanwhile the text may have changed: then a newer check is on its way.
            if self.opened().get(path) == opened.get(path):
                self.publish(path, list_of_findings, missing_domain(documents))

    def publish(
        self, path: Path, found: list[Finding], more: Sequence[types.Diagnostic] = ()
    ) -> None:
        """Shows findings in a document."""
        self.published[path] = found
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(
                uri=self.uri(path), diagnostics=[*map(as_diagnostic, found), *more]
            )
        )

    def locate(
        self, uri: str, position: types.Position
    ) -> tuple[list[symbols.Located], symbols.Located | None]:
        """All mentions of the family, and the one at a place."""
        found = symbols.located(self.family(uri))
        here = symbols.at(found, self.document(uri), position.line, position.character)
        return found, here

    def location(self, one: symbols.Located) -> types.Location:
        """Where a mention stands."""
        return types.Location(self.uri(one.document.path), as_range(one.mention.range))


def _path(uri: str) -> Path:
    return Path(to_fs_path(uri) or uri)


def create_server() -> PddlServer:
    """A server with all features registered."""
    server = PddlServer()
    _register_documents(server)
    _register_navigation(server)
    _register_editing(server)
    return server


def serve() -> None:
    """Speaks over stdin and stdout until the client leaves.

    What else writes to stdout, such as a library that an attachment loads, goes to stderr: a stray
    line would end the session.
    """
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as out:
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        create_server().start_io(stdout=out)


def _register_documents(server: PddlServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    async def did_open(ls: PddlServer, params: types.DidOpenTextDocumentParams) -> None:
        ls.schedule(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    async def did_change(ls: PddlServer, params: types.DidChangeTextDocumentParams) -> None:
        ls.schedule(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    async def did_close(ls: PddlServer, params: types.DidCloseTextDocumentParams) -> None:
        path = _path(params.text_document.uri)
        ls.published.pop(path, None)
        pending = ls.pending.pop(path, None)
        if pending is not None:
            pending.cancel()
        ls.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri=params.text_document.uri, diagnostics=[])
        )


def _register_navigation(server: PddlServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(ls: PddlServer, params: types.HoverParams) -> types.Hover | None:
        found, here = ls.locate(params.text_document.uri, params.position)
        if here is None:
            return None
        text = symbols.described(found, here.symbol)
        return types.Hover(
            types.MarkupContent(types.MarkupKind.Markdown, text), as_range(here.mention.range)
        )

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def definition(ls: PddlServer, params: types.DefinitionParams) -> types.Location | None:
        found, here = ls.locate(params.text_document.uri, params.position)
        declared = None if here is None else symbols.definition(found, here.symbol)
        return None if declared is None else ls.location(declared)

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    def references(ls: PddlServer, params: types.ReferenceParams) -> list[types.Location]:
        found, here = ls.locate(params.text_document.uri, params.position)
        if here is None:
            return []
        return [
            ls.location(one)
            for one in symbols.same(found, here.symbol)
            if params.context.include_declaration or not one.mention.definition
        ]

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def document_symbol(
        ls: PddlServer, params: types.DocumentSymbolParams
    ) -> list[types.DocumentSymbol]:
        document = ls.document(params.text_document.uri)
        found = symbols.located(ls.family(params.text_document.uri))
        return [
            types.DocumentSymbol(
                name=one.mention.text,
                kind=SYMBOL_KINDS[one.mention.kind],
                range=as_range(one.mention.declaration or one.mention.range),
                selection_range=as_range(one.mention.range),
                detail=one.mention.kind,
            )
            for one in found
            if one.mention.definition
            and one.document.path == document.path
            and one.mention.kind in SYMBOL_KINDS
        ]


def _register_editing(server: PddlServer) -> None:
    @server.feature(
        types.TEXT_DOCUMENT_COMPLETION,
        types.CompletionOptions(trigger_characters=["(", "[", ":", "?", "-", " "]),
    )
    def completion(ls: PddlServer, params: types.CompletionParams) -> list[types.CompletionItem]:
        document = ls.document(params.text_document.uri)
        domain = ls.family(params.text_document.uri).domain
        offered = _core.completions(
            document.text,
            params.position.line,
            params.position.character,
            None if domain is None else domain.text,
        )
        return [
            types.CompletionItem(label=text, kind=COMPLETION_KINDS[kind], detail=detail or None)
            for text, kind, detail in offered
        ]

    @server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    def rename(ls: PddlServer, params: types.RenameParams) -> types.WorkspaceEdit | None:
        found, here = ls.locate(params.text_document.uri, params.position)
        if here is None:
            return None
        new_name = _new_name(found, here.symbol, params.new_name)
        changes: dict[str, list[types.TextEdit]] = {}
        for one in symbols.same(found, here.symbol):
            edit = types.TextEdit(as_range(one.mention.range), new_name)
            changes.setdefault(ls.uri(one.document.path), []).append(edit)
        return types.WorkspaceEdit(changes=changes)

    @server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare_rename(
        ls: PddlServer, params: types.PrepareRenameParams
    ) -> types.PrepareRenamePlaceholder | None:
        _, here = ls.locate(params.text_document.uri, params.position)
        if here is None or here.symbol.name in {"object", "number"}:
            return None
        return types.PrepareRenamePlaceholder(as_range(here.mention.range), here.mention.text)

    @server.feature(types.TEXT_DOCUMENT_FORMATTING)
    def formatting(
        ls: PddlServer, params: types.DocumentFormattingParams
    ) -> list[types.TextEdit] | None:
        document = ls.document(params.text_document.uri)
        text, _ = _core.format_file((str(document.path), document.text.encode()))
        if text is None or text == document.text:
            return None
        last = document.text.count("\n") + 1
        return [types.TextEdit(as_range((0, 0, last, 0)), text)]

    @server.feature(
        types.TEXT_DOCUMENT_CODE_ACTION,
        types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix]),
    )
    def code_action(ls: PddlServer, params: types.CodeActionParams) -> list[types.CodeAction]:
        uri = params.text_document.uri
        found = ls.published.get(_path(uri), [])
        actions = [as_action(one, uri) for one in found if _touches(one, params.range)]
        return [action for action in actions if action is not None]


def _touches(one: Finding, place: types.Range) -> bool:
    line, column, end_line, end_column = one.range
    starts_before = (line, column) <= (place.end.line, place.end.character)
    ends_behind = (end_line, end_column) >= (place.start.line, place.start.character)
    return starts_before and ends_behind


def _new_name(found: list[symbols.Located], symbol: symbols.Symbol, wanted: str) -> str:
    """The new name; refuses what is no name or is taken already."""
    name = wanted.strip()
    variable = symbol.kind == "variable"
    plain = name.removeprefix("?") if variable else name
    if not NAME.fullmatch(plain):
        raise JsonRpcInvalidParams(
            message=f"{wanted!r} is no name: letters, digits, - and _, a letter first"
        )
    name = f"?{plain}" if variable else plain
    taken = symbols.Symbol(symbol.kind, name.lower(), symbol.scope, symbol.home)
    if name.lower() != symbol.name and symbols.definition(found, taken) is not None:
        raise JsonRpcInvalidParams(message=f"there is a {symbol.kind} {name!r} already")
    return name
