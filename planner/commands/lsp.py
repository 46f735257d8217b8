"""`marsupial lsp`: the language server over stdio."""

from typing import Annotated

import typer


def lsp(
    stdio: Annotated[  # noqa: ARG001 editors pass it, there is no other way to speak
        bool, typer.Option("--stdio", help="Speak over stdin and stdout (always so).")
    ] = True,
) -> None:
    """Serve editors by the Language Server Protocol; docs/editors.md says how to hook it in."""
    from planner.language_server.server import serve

    serve()
