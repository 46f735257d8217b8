"""SLAM: speed of matching and localization, then the experiments of thesis chapter 4."""

from pathlib import Path

from scenarios.benchmarks.slam.experiments import run_experiments
from scenarios.benchmarks.slam.speed import speed


def run(*, quick: bool, out: Path) -> str:
    """Measures everything; tables and figures also go to the folder `out`."""
    out.mkdir(parents=True, exist_ok=True)
    measured = speed(quick=quick)
    (out / "speed.md").write_text(measured + "\n", encoding="utf-8")
    return f"{measured}\n\n{run_experiments(out, quick=quick, data=Path('../shared/data'))}\n"
