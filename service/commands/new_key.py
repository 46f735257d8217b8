"""`marsupial new-key`."""

from pathlib import Path
from typing import Annotated, get_args

import typer

from service.access import Scope, new_key
from service.commands.exit_codes import USAGE_ERROR

SCOPES = get_args(Scope)


def new_api_key(
    name: Annotated[str, typer.Argument(help="Who will use it; appears in the audit log.")],
    keys: Annotated[Path, typer.Option(help="TOML file that the key's hash is added to.")] = Path(
        "keys.toml"
    ),
    scope: Annotated[
        list[str] | None,
        typer.Option(help="read, operate (missions, reports, plans) or edit; may be repeated."),
    ] = None,
    fleet: Annotated[
        list[str] | None, typer.Option(help="Fleet that it reaches; may be repeated.")
    ] = None,
) -> None:
    """Make an API key for `marsupial serve --keys`.

    The key itself is printed once and kept nowhere.
    """
    scopes = scope or ["read", "operate"]
    unknown = [one for one in scopes if one not in SCOPES]
    bad = [text for text in (name, *(fleet or [])) if '"' in text or "\\" in text or not text]
    if unknown or bad:
        there_are = ", ".join(SCOPES)
        what = (
            f"no scope {unknown[0]!r}: there are {there_are}"
            if unknown
            else f"{bad[0]!r} is no name"
        )
        typer.echo(what, err=True)
        raise typer.Exit(USAGE_ERROR)
    chosen: list[Scope] = [one for one in SCOPES if one in scopes]
    key, table = new_key(name, chosen, fleet or ["*"])
    with keys.open("a", encoding="utf-8") as file:
        file.write(table + "\n")
    keys.chmod(0o600)
    typer.echo(key)
