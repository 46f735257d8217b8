"""`marsupial bench`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.exit_codes import CommandError


def bench(
    topic: Annotated[
        str | None,
        typer.Argument(help="A topic, or all; without one the topics are listed."),
    ] = None,
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A small subset, in minutes.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for results.")] = Path("out/bench"),
) -> None:
    """Measure speed and quality; results are printed as Markdown and kept in a folder."""
    from importlib import import_module

    from scenarios.benchmarks import topics

    known = topics()
    if topic is None:
        for name, line in known.items():
            typer.echo(f"{name:<14} {line}")
        return
    chosen = list(known) if topic == "all" else [topic]
    for name in chosen:
        if name not in known:
            raise CommandError(
                f"no benchmark {name!r}: choose all or one of {', '.join(known) or '(none yet)'}"
            )
        module = import_module(f"scenarios.benchmarks.{name}")
        folder = out / name
        folder.mkdir(parents=True, exist_ok=True)
        table = module.run(quick=quick, out=folder)
        (folder / "results.md").write_text(table, encoding="utf-8")
        typer.echo(table)
