"""Headless fleets with lasers at 5 Hz: times faster than real time, and where the time goes."""

from scenarios.benchmarks.simulator.fleet_speed import run

__all__ = ["run"]
