"""Every request is measured, and every change is written to the audit log."""

import json
import logging
import time
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.metrics import Metrics

AUDIT = logging.getLogger("service.audit")


class Observation:
    """ASGI middleware: duration and status by route; who changed what."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        status = 500
        begun_s = time.perf_counter()

        async def observed(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self._app(scope, receive, observed)
        finally:
            route = getattr(scope.get("route"), "path", "unknown")
            duration_s = time.perf_counter() - begun_s
            self._metrics.requests.labels(scope["method"], route, str(status)).observe(duration_s)
            if scope["method"] not in ("GET", "HEAD") and not route.endswith("/reports"):
                AUDIT.info("%s", json.dumps(entry(scope, status)))


def entry(scope: Scope, status: int) -> dict[str, Any]:
    """A line of the audit log."""
    caller = scope.get("state", {}).get("caller")
    client = scope.get("client")
    return {
        "caller": None if caller is None else caller.name,
        "address": None if client is None else client[0],
        "method": scope["method"],
        "path": scope["path"],
        "status": status,
    }
