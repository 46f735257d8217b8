"""`marsupial serve` as far as it can be seen without listening."""

import pytest
import typer
from typer.testing import CliRunner

from service.commands.serve import is_loopback, serve


@pytest.mark.parametrize(
    ("host", "loopback"),
    [
        ("127.0.0.1", True),
        ("127.8.0.1", True),
        ("::1", True),
        ("localhost", True),
        ("0.0.0.0", False),
        ("::", False),
        ("192.168.0.7", False),
        ("example.org", False),
    ],
)
def test_loopback_addresses_are_known(host: str, *, loopback: bool) -> None:
    assert is_loopback(host) is loopback


def command() -> typer.Typer:
    app = typer.Typer()
    app.command()(serve)
    return app


def test_it_refuses_to_listen_where_others_can_reach_it() -> None:
    result = CliRunner().invoke(command(), ["--host", "0.0.0.0"])
    assert result.exit_code == 36
    assert "API key" in result.output


def test_a_database_that_is_none_gets_a_sentence() -> None:
    result = CliRunner().invoke(command(), ["--db", "carrier-pigeon://coop"])
    assert result.exit_code == 31
    assert "sqlite:///FILE" in result.output
    assert "Traceback" not in result.output
