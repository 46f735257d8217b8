"""Exploration by segments of the map: strategies, doorways and speed (thesis figure 2.8)."""

from scenarios.benchmarks.segments.report import run

__all__ = ["run"]
