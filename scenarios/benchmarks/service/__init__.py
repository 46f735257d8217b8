"""Many fleets at once: time to answer a report, time from a fact to new commands, memory."""

from scenarios.benchmarks.service.run import run

__all__ = ["run"]
