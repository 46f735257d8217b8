"""Traces of requests, replans and planning requests (OpenTelemetry); off without an endpoint.

FastAPI opens a span for every request and takes over a caller's `traceparent`. What a request gives
cause for afterwards (a replan, a planning request) is a span of the same trace, which goes on in
the worker. The extra `marsupial[telemetry]` brings what exports them.
"""

import importlib.metadata
import time
from collections.abc import Iterator, MutableMapping
from contextlib import contextmanager
from typing import Any

from fastapi.telemetry import TelemetryConfig
from opentelemetry import context, propagate, trace

QUIET = ("/healthz", "/readyz", "/metrics")
"""Asked by machines every few seconds."""


def exported_to(endpoint: str) -> trace.TracerProvider:
    """A provider whose spans go to an OTLP endpoint over HTTP, such as http://host:4318/v1/traces.

    Raises:
        ModuleNotFoundError: the extra is not installed.
    """
    from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
    from opentelemetry.sdk.resources import Resource
    from opentelemetry.sdk.trace import TracerProvider
    from opentelemetry.sdk.trace.export import BatchSpanProcessor

    version = importlib.metadata.version("marsupial")
    resource = Resource.create({"service.name": "marsupial", "service.version": version})
    provider = TracerProvider(resource=resource)
    provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter(endpoint=endpoint)))
    return provider


def of_requests(provider: trace.TracerProvider | None) -> TelemetryConfig:
    """How FastAPI traces: a span a request, none for its inner parts."""

    def is_quiet(scope: MutableMapping[str, Any]) -> bool:
        return scope.get("path") in QUIET

    return {
        "tracing": provider is not None,
        "tracer_provider": provider,
        "metrics": False,
        "logs": False,
        "operation_spans": False,
        "auto_configure": False,
        "exclude": is_quiet,
    }


def traceparent() -> str | None:
    """The span that this code runs in, in the notation of W3C Trace Context."""
    carrier: dict[str, str] = {}
    propagate.inject(carrier)
    return carrier.get("traceparent")


@contextmanager
def continued(parent: str | None) -> Iterator[None]:
    """Spans opened within belong to the trace of `parent`."""
    token = context.attach(propagate.extract({"traceparent": parent} if parent else {}))
    try:
        yield
    finally:
        context.detach(token)


def tell_past(tracer: trace.Tracer, *parts: tuple[str, float]) -> None:
    """Spans of parts that have just ended one after the other, by name and duration [s]."""
    end_ns = time.time_ns()
    for name, duration_s in reversed(parts):
        begin_ns = end_ns - int(duration_s * 1e9)
        tracer.start_span(name, start_time=begin_ns).end(end_ns)
        end_ns = begin_ns


def trace_id() -> str | None:
    """The trace that this code runs in, for logs."""
    found = trace.get_current_span().get_span_context()
    return trace.format_trace_id(found.trace_id) if found.is_valid else None
