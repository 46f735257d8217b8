"""The coordination service inside this process: the same routes, no socket.

The service's event loop runs in a thread of its own, so that a simulation, which is plain
synchronous code, talks to it through an ordinary `httpx.Client`.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Coroutine, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import httpx

from service.app import create_app
from service.settings import Settings

R = TypeVar("R")
ADDRESS = "http://in-process"


class InProcessTransport(httpx.BaseTransport):
    """Hands requests to an ASGI application that runs in another thread's event loop."""

    def __init__(self, app: Any, loop: asyncio.AbstractEventLoop) -> None:
        self._asgi = httpx.ASGITransport(app=app)
        self._loop = loop

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """Waits for the application's whole answer."""
        return asyncio.run_coroutine_threadsafe(self._answer(request), self._loop).result()

    async def _answer(self, request: httpx.Request) -> httpx.Response:
        sent = httpx.Request(
            request.method, request.url, headers=request.headers, content=request.read()
        )
        answer = await self._asgi.handle_async_request(sent)
        content = await answer.aread()
        return httpx.Response(
            answer.status_code, headers=answer.headers, content=content, request=request
        )


@contextmanager
def service_in_process(settings: Settings) -> Iterator[InProcessTransport]:
    """Starts the service, gives a transport to it, and shuts it down in the end."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, name="service", daemon=True)
    thread.start()

    def wait_for(work: Coroutine[Any, Any, R]) -> R:
        return asyncio.run_coroutine_threadsafe(work, loop).result()

    app = create_app(settings)
    lifespan = app.router.lifespan_context(app)
    try:
        wait_for(lifespan.__aenter__())
        try:
            yield InProcessTransport(app, loop)
        finally:
            wait_for(lifespan.__aexit__(None, None, None))
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()
