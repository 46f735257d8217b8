"""Executors by the name that an operator asks for."""

from collections.abc import Callable

from service.jobs.process_pool import process_pool
from service.jobs.worker_pool import PoolParameters, WorkerPool
from service.settings import Settings


def executor(
    settings: Settings, parameters: PoolParameters, waited: Callable[[float], None]
) -> WorkerPool:
    """A pool of the kind that the settings name.

    Raises:
        ModuleNotFoundError: its library is not installed.
    """
    if settings.executor == "ray":
        from service.jobs.ray_pool import ray_pool

        pool = ray_pool(parameters, settings.ray_address, waited)
    else:
        pool = process_pool(parameters, waited)
    if settings.warm_pool:
        pool.warm_up()
    return pool


def release(settings: Settings) -> None:
    """Lets go of what all pools of a service share, after they are closed."""
    if settings.executor == "ray":
        from service.jobs.ray_pool import leave

        leave()
