"""`marsupial bench`."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Annotated, Literal

import typer

from scenarios.exit_codes import CommandError


def bench(
    topic: Annotated[
        str | None,
        typer.Argument(
            help="A topic, a suite (its name or a TOML file), or all topics; without one they are "
            "listed.",
            show_default=False,
        ),
    ] = None,
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A small subset, in minutes.")] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Missions of a suite at the same time.")] = 1,
    executor: Annotated[
        Literal["process", "ray"], typer.Option(help="Where the missions of a suite run.")
    ] = "process",
    resume: Annotated[
        bool, typer.Option("--resume", help="Do only the runs of a suite that are missing.")
    ] = False,
    seconds: Annotated[
        float | None,
        typer.Option(
            min=0.1, help="CPU seconds a run, for topics that have runs.", show_default=False
        ),
    ] = None,
    domains: Annotated[
        list[str] | None,
        typer.Option(
            "--domains", help="Only families with this word; may be repeated.", show_default=False
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for results.")] = Path("out/bench"),
) -> None:
    """Measure speed and quality, or run a suite of missions and compare strategies.

    Results are printed as Markdown and kept in a folder; a suite also gets report.html, runs.csv
    and comparisons.csv.
    """
    from scenarios.benchmarks import topics

    known = topics()
    suites = suite_files()
    if topic is None:
        for name, line in known.items():
            typer.echo(f"{name:<24} {line}")
        for name in suites:
            typer.echo(f"{name:<24} suite: {suites[name]}")
    elif topic == "all":
        for name in known:
            _measure(name, out / name, quick=quick)
    elif topic in known:
        chosen = {"seconds": seconds, "domains": tuple(domains or ()), "resume": resume}
        _measure(topic, out / topic, quick=quick, chosen=chosen)
    elif topic in suites or topic.endswith(".toml"):
        from scenarios.batch.command import run_suite

        path = suites.get(topic, Path(topic))
        run_suite(path, out / path.stem, quick=quick, jobs=jobs, resume=resume, executor=executor)
    else:
        choices = ", ".join(("all", *known, *suites))
        raise CommandError(f"no benchmark {topic!r}: choose one of {choices}, or a suite's file")


def suite_files() -> dict[str, Path]:
    """The suites that come with marsupial, by name."""
    folder = Path(__file__).parents[1] / "suites"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def _measure(
    name: str, folder: Path, *, quick: bool, chosen: Mapping[str, object] | None = None
) -> None:
    module = import_module(f"scenarios.benchmarks.{name}")
    folder.mkdir(parents=True, exist_ok=True)
    known = signature(module.run).parameters
    given = {key: value for key, value in (chosen or {}).items() if value}
    if unknown := sorted(given.keys() - known.keys()):
        raise CommandError(f"{name} has no option --{unknown[0]}")
    table: str = module.run(quick=quick, out=folder, **given)
    (folder / "results.md").write_text(table, encoding="utf-8")
    typer.echo(table)
