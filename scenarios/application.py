"""The command line as users see it: one Typer application with one command loaded.

Only the module of the command that is asked for is imported: a validation must not wait for the
physics engine, nor a service for the report's charts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import version as installed_version
from typing import Annotated, Any

import typer
from typer.exceptions import TyperException

from scenarios.exit_codes import USAGE_ERROR

COMMANDS: dict[str, tuple[str, str, str]] = {
    "demo": (
        "scenarios.commands.demo:demo",
        "Missions",
        "Run the hospital mission and write its report.",
    ),
    "run": ("scenarios.commands.run:run", "Missions", "Run a scenario file."),
    "replay": (
        "scenarios.commands.replay:replay",
        "Missions",
        "Play a mission again from its log.",
    ),
    "bench": (
        "scenarios.commands.bench:bench",
        "Missions",
        "Run a benchmark or a suite of missions.",
    ),
    "plan": ("scenarios.commands.planning:plan", "Planning", "Solve a PDDL problem."),
    "validate": ("scenarios.commands.planning:validate", "Planning", "Check a plan."),
    "compile-attachments": (
        "scenarios.commands.planning:compile_attachments",
        "Planning",
        "Write plain PDDL 2.1 with the attachments' values as fluents.",
    ),
    "check": (
        "planner.commands.check:check",
        "PDDL files",
        "Find faults in a domain and problems.",
    ),
    "explain": ("planner.commands.explain:explain", "PDDL files", "Explain a diagnostic code."),
    "format": ("planner.commands.format:format_files", "PDDL files", "Format PDDL files."),
    "lsp": ("planner.commands.lsp:lsp", "PDDL files", "Serve editors over stdio."),
    "map": (
        "scenarios.commands.maps:app",
        "Maps",
        "Build, look at and convert 3D occupancy maps.",
    ),
    "slam": (
        "scenarios.commands.slam:app",
        "Maps",
        "Map by SLAM, optimise pose graphs, merge robots' maps.",
    ),
    "vegetation": (
        "scenarios.commands.vegetation:app",
        "Maps",
        "Detect flat vegetation from laser remission, and map it.",
    ),
    "serve": ("service.commands.serve:serve", "Service", "Run the coordination service over HTTP."),
    "new-key": ("service.commands.new_key:new_api_key", "Service", "Make an API key."),
}
"""command: where it lives, its panel in the help, its line in the help"""


def application(arguments: Sequence[str]) -> typer.Typer:
    """The command line with the command that `arguments` name; the others are lines of the help."""
    app = typer.Typer(
        name="marsupial",
        add_completion=False,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_main_options)
    asked = next((word for word in arguments if word in COMMANDS), None)
    for name, (target, panel, line) in COMMANDS.items():
        if name == asked:
            loaded = load(target)
            if isinstance(loaded, typer.Typer):
                app.add_typer(loaded, name=name, rich_help_panel=panel)
            else:
                app.command(name, rich_help_panel=panel)(loaded)
        else:
            app.command(name, help=line, rich_help_panel=panel)(_not_asked)
    return app


def load(target: str) -> Callable[..., Any] | typer.Typer:
    """The function, or the group of commands, `module:name`."""
    module, _, name = target.partition(":")
    found: Callable[..., Any] | typer.Typer = getattr(import_module(module), name)
    return found


def run_application(words: Sequence[str]) -> Any:
    """Runs a command; its exit code."""
    try:
        return application(words)(args=words, prog_name="marsupial", standalone_mode=False)
    except TyperException as wrong_usage:
        wrong_usage.show()  # type: ignore[attr-defined]  # every one of them has it
        return USAGE_ERROR
    except typer.Abort:
        raise KeyboardInterrupt from None


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"marsupial {installed_version('marsupial')}")
        raise typer.Exit


def _main_options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of a fault.")] = False,
) -> None:
    """Coordinates teams of unlike robots by temporal planning."""


def _not_asked() -> None:
    raise AssertionError("only the command that was asked for is run")
