"""The `marsupial` command.

Only the module of the command that is asked for is imported: a first plan must not wait for the web
framework, nor a validation for the physics engine.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import version as installed_version
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.exceptions import TyperException

from scenarios.exit_codes import FAULT, INPUT_ERROR, INTERRUPTED, USAGE_ERROR, CommandError

COMMANDS: dict[str, tuple[str, str, str]] = {
    "demo": (
        "scenarios.commands.demo:demo",
        "Missions",
        "Run the hospital mission and write its report.",
    ),
    "run": ("scenarios.commands.run:run", "Missions", "Run a scenario file."),
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
            app.command(name, rich_help_panel=panel)(load(target))
        else:
            app.command(name, help=line, rich_help_panel=panel)(_not_asked)
    return app


def load(target: str) -> Callable[..., Any]:
    """The function `module:name`."""
    module, _, name = target.partition(":")
    function: Callable[..., Any] = getattr(import_module(module), name)
    return function


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line; a user sees sentences, never a traceback."""
    # No command multiplies large matrices, and starting BLAS threads takes more CPU than reading
    # a map and a problem.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    words = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
    try:
        stranger = someone_elses_room()
        if stranger is not None:
            raise CommandError(stranger, FAULT)
        sys.exit(application(words)(args=words, prog_name="marsupial", standalone_mode=False))
    except CommandError as failure:
        _say(str(failure))
        sys.exit(failure.exit_code)
    except TyperException as wrong_usage:
        wrong_usage.show()  # type: ignore[attr-defined]  # every one of them has it
        sys.exit(USAGE_ERROR)
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(128 + signal.SIGPIPE)
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        _say(f"{error.filename}: {error.strerror}; check the path")
        sys.exit(INPUT_ERROR)
    except Exception as fault:
        if "--debug" in words:
            raise
        _say(
            f"this should not have happened: {type(fault).__name__}: {fault}\n"
            "`marsupial --debug ...` shows where; please report it with that output."
        )
        sys.exit(FAULT)


def someone_elses_room() -> str | None:
    """What is wrong if another distribution's package of the same name comes first on the path."""
    home = Path(__file__).resolve().parent.parent
    for room in ("planner", "semantic_attachments", "domains", "service", "simulator"):
        found = find_spec(room)
        if found is None or found.origin is None:
            return f"marsupial's package {room!r} is missing: install it again"
        if Path(found.origin).resolve().parent.parent != home:
            return (
                f"the package {room!r} at {found.origin} is not marsupial's: "
                "install marsupial into a virtual environment of its own"
            )
    return None


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


def _say(message: str) -> None:
    sys.stderr.write(f"marsupial: {message}\n")


if __name__ == "__main__":
    main()
