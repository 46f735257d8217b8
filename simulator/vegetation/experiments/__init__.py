"""The experiments of section 6.9, in simulation and on public data.

Each module has `run(setting) -> str`: it writes its figures into a folder and returns Markdown.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

EXPERIMENTS: dict[str, str] = {
    "table_6_1": "self-supervised classifier of an LMS 291, tested in another place; baselines",
    "table_6_2": "SVM and LDA for three scanners",
    "mapping": "vegetation map of 0.1 m from a drive with a fixed scanner (6.9.3)",
    "navigation": "to a goal 80 m away without a map (6.9.4)",
    "long_navigation": "1,120 m on a map made before, LMS 151 (6.9.5)",
    "real_remission": "RELLIS-3D and SemanticKITTI: grass and hard ground",
    "real_vibration": "wheelchair and Husky: grass and hard ground",
}


@dataclass(frozen=True, slots=True)
class Setting:
    """Where an experiment reads and writes, and how much it does."""

    out: Path
    quick: bool = False
    """A small version, in seconds: the numbers of the report come from the whole one."""
    data: Path = Path("../shared/data")
    """Public data sets; experiments say what they miss there."""


def run(name: str, setting: Setting) -> str:
    """Runs one experiment of `EXPERIMENTS`; returns its part of the report."""
    setting.out.mkdir(parents=True, exist_ok=True)
    module = import_module(f"{__name__}.{name}")
    report: str = module.run(setting)
    return report
