"""Runs of a suite on a Ray cluster, each still in a process of its own with limits."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from scenarios.batch.run_process import Row, run_in_process
from scenarios.batch.suite import RunSpec, Suite
from scenarios.exit_codes import CommandError


def on_ray(jobs: int) -> Callable[[Suite, RunSpec], Row]:
    """A function that performs a run somewhere on the cluster that `RAY_ADDRESS` names.

    Without an address a cluster of `jobs` workers is started on this machine.

    Raises:
        CommandError: Ray is not installed.
    """
    try:
        import ray
    except ImportError:
        raise CommandError(
            "--executor ray needs Ray: install it with `pip install marsupial[cluster]`"
        ) from None
    if not ray.is_initialized():
        ray.init(
            num_cpus=jobs, include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR
        )
    remote: Any = ray.remote(num_cpus=1, max_retries=2)(run_in_process)

    def perform(suite: Suite, spec: RunSpec) -> Row:
        row: Row = ray.get(remote.remote(suite, spec))
        return row

    return perform
