"""What an operator decides: one frozen object, passed in from the command line."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from service.access import ApiKey

ExecutorName = Literal["processes", "threads", "ray"]


class Settings(BaseModel):
    """How the service runs."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    database_url: str = "sqlite:///marsupial.sqlite"
    """SQLAlchemy URL of the event log."""
    api_keys: list[ApiKey] = Field(default_factory=list)
    """Without keys everything is open."""
    executor: ExecutorName = "processes"
    """Where planning runs: worker processes of this machine, threads (missions only), or Ray."""
    ray_address: str | None = None
    """Ray cluster to join; None starts Ray on this machine."""
    warm_pool: bool = False
    """Whether workers are started before there is work for them."""
    planning_workers: int = Field(default=2, ge=1)
    """Replans computed at the same time."""
    planning_processes: int = Field(default=2, ge=1)
    """Workers for planning requests."""
    planning_queue: int = Field(default=100, ge=0)
    """Planning requests that wait at most."""
    planning_memory_mb: int = Field(default=4096, ge=256)
    """Address space of a worker process [MiB]."""
    traces_to: str | None = None
    """OTLP endpoint for traces, such as http://host:4318/v1/traces; None traces nothing."""
    drain_s: float = Field(default=10.0, ge=0.0)
    """How long planning requests under way may take when the service is asked to stop."""
    max_pddl_bytes: int = Field(default=2 * 2**20, ge=1024)
    """Length of a domain or problem text."""
    debounce_s: float = Field(default=0.05, ge=0.0)
    """Facts that arrive within this time share one replan [wall clock]."""
    idle_replan_s: float = Field(default=30.0, gt=0.0)
    """A robot without an order gets a fresh look after this time [fleet clock]."""
    give_up_s: float = Field(default=60.0, gt=0.0)
    """A robot that is late by that much and stands still has failed its command [fleet clock]."""
    hopeless_s: float = Field(default=300.0, gt=0.0)
    """A mission fails when for so long the team could do nothing [fleet clock]."""
    max_body_bytes: int = Field(default=32 * 2**20, ge=1024)
    max_map_cells: int = Field(default=16_000_000, ge=1)
    max_scan_map_mb: int = Field(default=512, ge=1)
    """What the 3D map of a mission may take; scans beyond are refused [MB]."""
    scan_maps_folder: Path | None = None
    """Where 3D maps are kept for a restart; without it they live as long as the service."""
    max_missions: int = Field(default=1000, ge=1)
    """Missions that are not over."""
    max_wait_s: float = Field(default=60.0, ge=0.0)
    """The longest `Prefer: wait` that is honoured."""


def sqlite_url(path: Path) -> str:
    """The URL of a SQLite file."""
    return f"sqlite:///{path}"
