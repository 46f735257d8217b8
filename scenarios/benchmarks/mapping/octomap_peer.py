"""OctoMap itself, through octomap-python, with the sensor model of our maps."""

from __future__ import annotations

from math import exp
from typing import Any

from scenarios.exit_codes import CommandError
from simulator.mapping.octree import SensorModel

LEAF_BYTES, INNER_BYTES = 16, 80
"""Of OctoMap's nodes on 64 bits: a pointer and a float; and eight pointers where there are
children."""


def octomap_tree(resolution_m: float, model: SensorModel) -> Any:
    """An empty tree of the real OctoMap."""
    try:
        import octomap
    except ImportError:
        raise CommandError(
            "this is measured beside OctoMap, which is not installed: pip install octomap-python"
        ) from None
    tree = octomap.OcTree(resolution_m)
    tree.setProbHit(_probability(model.hit))
    tree.setProbMiss(_probability(model.miss))
    tree.setClampingThresMin(_probability(model.lowest))
    tree.setClampingThresMax(_probability(model.highest))
    return tree


def _probability(log_odds: float) -> float:
    return 1 / (1 + exp(-log_odds))
