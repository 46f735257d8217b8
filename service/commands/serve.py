"""`marsupial serve`."""

import ipaddress
import json
import logging
import sys
from importlib.util import find_spec
from pathlib import Path
from types import FrameType
from typing import Annotated, NoReturn, cast, get_args

import typer
import uvicorn

from service.access import ApiKey, KeyFileError, read_keys
from service.app import create_app
from service.commands.exit_codes import INPUT_ERROR, USAGE_ERROR
from service.draining import Draining
from service.settings import ExecutorName, Settings
from service.store.engine import DatabaseUrlError, connect
from service.tracing import trace_id

DRAIN_S = 10
"""How long requests under way may take after SIGTERM."""


def serve(  # noqa: PLR0917 - options of a command line, never positional
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="TCP port; 0 takes a free one.")
    ] = 8080,
    db: Annotated[
        str,
        typer.Option(
            envvar="MARSUPIAL_DB",
            help="Database URL: sqlite:///FILE or postgresql+psycopg://...",
        ),
    ] = "sqlite:///marsupial.sqlite",
    keys: Annotated[
        Path | None, typer.Option(help="TOML file of API keys, made by `marsupial new-key`.")
    ] = None,
    executor: Annotated[
        str,
        typer.Option(
            help="Where planning runs: processes, threads (missions only), or ray "
            "(extra marsupial[cluster])."
        ),
    ] = "processes",
    ray_address: Annotated[
        str | None,
        typer.Option(help="Ray cluster to join; without it Ray is started on this machine."),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Replans computed at the same time.")] = 2,
    request_workers: Annotated[
        int, typer.Option(min=1, help="Planning requests computed at the same time.")
    ] = 2,
    worker_memory_mb: Annotated[
        int, typer.Option(min=256, help="Address space of a planning worker [MiB].")
    ] = 4096,
    request_queue: Annotated[
        int, typer.Option(min=0, help="Planning requests that wait at most; then 429.")
    ] = 100,
    max_missions: Annotated[
        int, typer.Option(min=1, help="Missions that are open at most; then 429.")
    ] = 1000,
    scan_maps: Annotated[
        Path | None,
        typer.Option(help="Folder in which missions' 3D maps outlive a restart; none are kept."),
    ] = None,
    give_up_s: Annotated[
        float,
        typer.Option(
            min=1.0,
            help="A robot that is late by that much and stands still has failed its command "
            "[s, fleet clock].",
        ),
    ] = 60.0,
    hopeless_s: Annotated[
        float,
        typer.Option(
            min=1.0,
            help="A mission fails when for so long the team could do nothing [s, fleet clock].",
        ),
    ] = 300.0,
    traces_to: Annotated[
        str | None,
        typer.Option(
            help="OTLP endpoint for traces, such as http://localhost:4318/v1/traces "
            "(extra marsupial[telemetry])."
        ),
    ] = None,
    json_logs: Annotated[
        bool, typer.Option("--json-logs", help="Log a JSON object a line.")
    ] = False,
) -> None:
    """Run the coordination service over HTTP.

    Missions are kept in the database: a service that is stopped, or killed, goes on where it
    was when it is started again with the same database.
    """
    api_keys = _keys(keys)
    if not is_loopback(host) and not api_keys:
        _refuse(
            f"{host} is not a loopback address, and without API keys whoever reaches the port "
            "could command the fleet: give --keys FILE (see `marsupial new-key`), or listen on "
            "127.0.0.1.",
            USAGE_ERROR,
        )
    try:
        connect(db).connect().close()
    except DatabaseUrlError as error:
        _refuse(str(error), INPUT_ERROR)
    except Exception as error:
        _refuse(f"the database {db} cannot be opened: {error}", INPUT_ERROR)
    if traces_to is not None and find_spec("opentelemetry.exporter") is None:
        _refuse("traces need an exporter: pip install 'marsupial[telemetry]'", USAGE_ERROR)
    settings = Settings(
        database_url=db,
        api_keys=api_keys,
        executor=_executor(executor),
        ray_address=ray_address,
        warm_pool=True,
        planning_workers=workers,
        planning_processes=request_workers,
        planning_memory_mb=worker_memory_mb,
        planning_queue=request_queue,
        max_missions=max_missions,
        scan_maps_folder=scan_maps,
        give_up_s=give_up_s,
        hopeless_s=hopeless_s,
        traces_to=traces_to,
    )
    log_to_stderr(as_json=json_logs)
    app = create_app(settings)
    server = DrainingServer(
        uvicorn.Config(
            app,
            host=host,
            port=port,
            log_config=None,
            access_log=False,
            timeout_graceful_shutdown=DRAIN_S,
        ),
        app.state.draining,
    )
    server.run()
    if not server.started:
        raise typer.Exit(INPUT_ERROR)


class DrainingServer(uvicorn.Server):
    """Ends the streams when it is asked to stop; they would keep it waiting."""

    def __init__(self, config: uvicorn.Config, draining: Draining) -> None:
        super().__init__(config)
        self._draining = draining

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """SIGTERM or SIGINT."""
        self._draining.begin()
        super().handle_exit(sig, frame)


def _keys(path: Path | None) -> list[ApiKey]:
    if path is None:
        return []
    try:
        return read_keys(path)
    except KeyFileError as error:
        _refuse(str(error), INPUT_ERROR)


def _executor(name: str) -> ExecutorName:
    if name not in get_args(ExecutorName):
        names = ", ".join(get_args(ExecutorName))
        _refuse(f"no executor {name!r}: there are {names}", USAGE_ERROR)
    if name == "ray" and find_spec("ray") is None:
        _refuse("Ray is not installed: pip install 'marsupial[cluster]'", USAGE_ERROR)
    return cast(ExecutorName, name)


def _refuse(why: str, exit_code: int) -> NoReturn:
    typer.echo(why, err=True)
    raise typer.Exit(exit_code)


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class JsonLines(logging.Formatter):
    """A JSON object a line, for machines."""

    def format(self, record: logging.LogRecord) -> str:
        """The record's time, level, logger and message."""
        line = {
            "time": self.formatTime(record),
            "level": record.levelname,
            "logger": record.name,
            "message": record.getMessage(),
        }
        if (trace := trace_id()) is not None:
            line["trace_id"] = trace
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line)


def log_to_stderr(*, as_json: bool) -> None:
    """Everything from INFO on, as text or JSON lines."""
    handler = logging.StreamHandler(sys.stderr)
    plain = logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s")
    handler.setFormatter(JsonLines() if as_json else plain)
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
