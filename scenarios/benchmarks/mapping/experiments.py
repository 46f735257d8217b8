"""The experiments by name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from scenarios.benchmarks.mapping import (
    beside_octomap,
    exploring,
    insertion,
    memory,
    segmentation,
    tables,
)

EXPERIMENTS: dict[str, tuple[str, Callable[[bool, Path], str]]] = {
    "octomap": ("Beside OctoMap in one run", lambda quick, _: beside_octomap.measure(quick=quick)),
    "memory": ("Memory and file sizes (table 5.2, figure 5.16)", memory.measure),
    "insertion": ("Time of insertion (figure 5.17)", insertion.measure),
    "tables": ("Hierarchies of maps (figures 5.19 to 5.22)", tables.measure),
    "segmentation": ("Real tabletops (section 5.3.4)", segmentation.measure),
    "exploration": ("Exploration by information gain (sections 5.4 and 5.5.7)", exploring.measure),
}
"""name: title, and what measures, draws into a folder and returns Markdown"""
