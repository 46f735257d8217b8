"""A client that calls the application in its process, from synchronous tests."""

import asyncio
import threading
from collections.abc import Coroutine, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any, TypeVar

import httpx
from fastapi import FastAPI

T = TypeVar("T")


class InProcessClient:
    """Requests without a socket; the application's event loop turns in a thread of its own."""

    def __init__(self, app: FastAPI, loop: asyncio.AbstractEventLoop) -> None:
        self.app = app
        self._loop = loop
        self._http = httpx.AsyncClient(
            transport=httpx.ASGITransport(app=app, raise_app_exceptions=True),
            base_url="http://service",
            timeout=60.0,
        )

    def run(self, work: Coroutine[Any, Any, T]) -> T:
        """The result of a coroutine in the application's loop."""
        future: Future[T] = asyncio.run_coroutine_threadsafe(work, self._loop)
        return future.result(60.0)

    def request(self, method: str, path: str, **more: Any) -> httpx.Response:
        return self.run(self._http.request(method, path, **more))

    def start(self, method: str, path: str, **more: Any) -> "Future[httpx.Response]":
        """A request whose answer is asked for later."""
        work = self._http.request(method, path, **more)
        return asyncio.run_coroutine_threadsafe(work, self._loop)

    def get(self, path: str, **more: Any) -> httpx.Response:
        return self.request("GET", path, **more)

    def post(self, path: str, **more: Any) -> httpx.Response:
        return self.request("POST", path, **more)

    def delete(self, path: str, **more: Any) -> httpx.Response:
        return self.request("DELETE", path, **more)


@contextmanager
def serving(app: FastAPI) -> Iterator[InProcessClient]:
    """The application, started and in the end stopped as a server would."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, name="application")
    thread.start()
    client = InProcessClient(app, loop)
    lifespan = app.router.lifespan_context(app)
    try:
        client.run(lifespan.__aenter__())
        try:
            yield client
        finally:
            client.run(lifespan.__aexit__(None, None, None))
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()
