"""3D maps beside OctoMap in one run: equality, speed, memory, rays, files, hierarchies."""

from __future__ import annotations

from pathlib import Path

from scenarios.benchmarks.mapping.experiments import EXPERIMENTS

__all__ = ["run"]


def run(*, quick: bool, out: Path) -> str:
    """Runs every experiment; figures are written into `out`."""
    return "\n\n".join(
        f"## {title}\n\n{experiment(quick, out)}" for title, experiment in EXPERIMENTS.values()
    )
