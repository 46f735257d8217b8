"""What operators measure, in the format of Prometheus; one registry an application."""

from opentelemetry.trace import Tracer
from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_LATEST

CONTENT_TYPE = CONTENT_TYPE_LATEST
_SECONDS = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0)


class Metrics:
    """Counters, gauges and histograms of one service."""

    def __init__(self, tracer: Tracer) -> None:
        self.tracer = tracer
        self.registry = CollectorRegistry()
        self.requests = Histogram(
            "marsupial_http_request_seconds",
            "Time from request to answer",
            ["method", "route", "status"],
            buckets=_SECONDS,
            registry=self.registry,
        )
        self.replanning = Histogram(
            "marsupial_replanning_seconds",
            "Time from the first fact to new commands",
            ["outcome"],
            buckets=_SECONDS,
            registry=self.registry,
        )
        self.facts = Counter(
            "marsupial_facts_total", "Facts that asked for a replan", registry=self.registry
        )
        self.missions = Gauge(
            "marsupial_missions_open", "Missions that are not over", registry=self.registry
        )
        self.plans_queued = Gauge(
            "marsupial_plan_requests_queued", "Planning requests waiting", registry=self.registry
        )
        self.plans_running = Gauge(
            "marsupial_plan_requests_running", "Planning requests running", registry=self.registry
        )
        self.worker_restarts = Gauge(
            "marsupial_worker_restarts",
            "Planning workers killed or crashed, and replaced",
            ["kind"],
            registry=self.registry,
        )
        self.waiting = Histogram(
            "marsupial_planning_wait_seconds",
            "Time that replans and planning requests waited for a worker",
            ["kind"],
            buckets=_SECONDS,
            registry=self.registry,
        )
        self.replans_queued = Gauge(
            "marsupial_replans_queued", "Replans waiting for a worker", registry=self.registry
        )
        self.replans_running = Gauge(
            "marsupial_replans_running", "Replans being computed", registry=self.registry
        )
        self.remaining_makespan = Histogram(
            "marsupial_plan_makespan_seconds",
            "Makespan of the plans that came into force, from then on",
            buckets=(10, 30, 60, 120, 300, 600, 1200, 3600),
            registry=self.registry,
        )

    def replan_waited(self, duration_s: float) -> None:
        """A replan has found a worker."""
        self.waiting.labels("replan").observe(duration_s)

    def request_waited(self, duration_s: float) -> None:
        """A planning request has found a worker."""
        self.waiting.labels("request").observe(duration_s)

    def replanned(self, outcome: str, duration_s: float, makespan_s: float | None) -> None:
        """A replan has ended."""
        self.replanning.labels(outcome).observe(duration_s)
        if makespan_s is not None:
            self.remaining_makespan.observe(makespan_s)

    def noticed(self, count: int) -> None:
        """Facts came in that ask for a replan."""
        self.facts.inc(count)

    def exposition(self) -> bytes:
        """All of it as text."""
        return generate_latest(self.registry)
