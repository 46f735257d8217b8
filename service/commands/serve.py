"""`marsupial serve`."""

import ipaddress
from typing import Annotated

import typer
import uvicorn

from service.app import create_app
from service.settings import Settings
from service.store.engine import DatabaseUrlError, connect


def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="TCP port; 0 takes a free one.")
    ] = 8080,
    db: Annotated[
        str, typer.Option(help="Database URL: sqlite:///FILE or postgresql+psycopg://...")
    ] = "sqlite:///marsupial.sqlite",
) -> None:
    """Run the coordination service over HTTP.

    Missions are kept in the database: a service that is stopped, or killed, goes on where it
    was when it is started again with the same database.
    """
    if not is_loopback(host):
        typer.echo(
            f"{host} is not a loopback address, and this server has no API keys: whoever reaches "
            "the port could command the fleet. Listen on 127.0.0.1.",
            err=True,
        )
        raise typer.Exit(2)
    try:
        connect(db).connect().close()
    except DatabaseUrlError as error:
        typer.echo(str(error), err=True)
        raise typer.Exit(2) from None
    uvicorn.run(create_app(Settings(database_url=db)), host=host, port=port, log_level="info")


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
