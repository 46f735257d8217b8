"""Requests that are sent until they are answered: what a client does about a service that is away.

A request that may be repeated is sent again whenever no answer came or the service was in trouble;
any other only if the service cannot have acted on it.
"""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import httpx


class ServiceError(RuntimeError):
    """The service cannot be reached, or refuses; the message says what to do."""

    def __init__(self, message: str, status: int | None = None, problem: Any = None) -> None:
        super().__init__(message)
        self.status = status
        """HTTP status of a refusal; None if there was no answer."""
        self.problem: dict[str, Any] = problem if isinstance(problem, dict) else {}
        """The refusal as the service tells it (RFC 9457)."""


@dataclass(frozen=True, slots=True)
class Patience:
    """How long a client keeps trying [wall clock]."""

    first_wait_s: float = 0.1
    longest_wait_s: float = 2.0
    give_up_after_s: float = 60.0
    answer_within_s: float = 10.0
    """An answer that takes longer than this, and what was asked for to wait, is lost."""


@dataclass(slots=True)
class Connection:
    """HTTP with patience, over any `httpx.Client` with a `base_url`, also one without a socket."""

    http: httpx.Client
    patience: Patience = field(default_factory=Patience)
    key: str | None = None
    """API key."""
    sleep: Callable[[float], None] = time.sleep
    now: Callable[[], float] = time.monotonic
    retries: int = 0
    """Requests that had to be sent again."""

    def send(
        self,
        method: str,
        path: str,
        *,
        content: str | bytes | None = None,
        headers: Mapping[str, str] | None = None,
        wait_s: float = 0.0,
        repeatable: bool = True,
    ) -> httpx.Response:
        """The answer to a request.

        Args:
            wait_s: how long the service may wait until something is done (`Prefer: wait=N`).
            repeatable: whether it does no harm if the service gets the request twice.

        Raises:
            ServiceError: refused, or the service stays away.
        """
        sent = {**self._headers(), **(headers or {})}
        if content is not None:
            sent.setdefault("Content-Type", "application/json")
        if wait_s > 0.0:
            sent["Prefer"] = f"wait={wait_s:.0f}"
        waiting = self.waiting(method, path)
        while True:
            asked_s = 0.0
            try:
                answer = self.http.request(
                    method,
                    path,
                    content=content,
                    headers=sent,
                    timeout=wait_s + self.patience.answer_within_s,
                )
            except httpx.TransportError as error:
                trouble = f"{type(error).__name__}: {error}".strip(": ")
                if not repeatable and not isinstance(
                    error, (httpx.ConnectError, httpx.ConnectTimeout)
                ):
                    raise ServiceError(
                        f"no answer to {method} {path} ({trouble}); look whether it was done "
                        "before sending it again"
                    ) from None
            else:
                if answer.status_code < 400:
                    return answer
                if not _is_passing(answer.status_code, repeatable=repeatable):
                    raise refusal(method, path, answer)
                trouble = f"status {answer.status_code}"
                asked_s = _retry_after_s(answer)
            waiting.pause(trouble, asked_s)

    @contextmanager
    def stream(self, path: str, headers: Mapping[str, str]) -> Iterator[httpx.Response]:
        """An answer that goes on; without patience.

        Raises:
            ServiceError: refused.
            httpx.TransportError: no answer.
        """
        timeout = httpx.Timeout(self.patience.answer_within_s, read=self.patience.give_up_after_s)
        sent = {**self._headers(), **headers}
        with self.http.stream("GET", path, headers=sent, timeout=timeout) as answer:
            if answer.status_code >= 400:
                answer.read()
                raise refusal("GET", path, answer)
            yield answer

    def waiting(self, method: str, path: str) -> "Waiting":
        """Patience for one request, from now on."""
        return Waiting(self, f"{method} {path}", self.now(), self.patience.first_wait_s)

    def _headers(self) -> dict[str, str]:
        return {} if self.key is None else {"Authorization": f"Bearer {self.key}"}


@dataclass(slots=True)
class Waiting:
    """Waits longer and longer, until patience is at its end."""

    connection: Connection
    request: str
    begin_s: float
    wait_s: float

    def pause(self, trouble: str, asked_s: float = 0.0) -> None:
        """Waits, at least as long as the service has asked for.

        Raises:
            ServiceError: it has taken too long.
        """
        connection, patience = self.connection, self.connection.patience
        pause_s = max(self.wait_s, asked_s)
        if connection.now() - self.begin_s + pause_s > patience.give_up_after_s:
            raise ServiceError(
                f"the service at {connection.http.base_url} has not answered {self.request} for "
                f"{patience.give_up_after_s:g} s ({trouble}); start it with `marsupial serve` or "
                "check the address"
            )
        connection.retries += 1
        connection.sleep(pause_s)
        self.wait_s = min(2.0 * self.wait_s, patience.longest_wait_s)


def _is_passing(status: int, *, repeatable: bool) -> bool:
    """Whether the same request may be answered otherwise later, and does no harm."""
    if status in (429, 503):
        return True  # nothing was done
    return repeatable and (status >= 500 or status == 408)


def _retry_after_s(answer: httpx.Response) -> float:
    try:
        return max(0.0, float(answer.headers.get("Retry-After", "0")))
    except ValueError:
        return 0.0


def refusal(method: str, path: str, answer: httpx.Response) -> ServiceError:
    """What the service says about a request that it does not serve."""
    try:
        problem = answer.json()
    except ValueError:
        problem = None
    told = problem if isinstance(problem, dict) else {}
    said = str(told.get("detail") or told.get("title") or answer.text[:200])
    places = "; ".join(
        f"{error.get('location')}: {error.get('message')}" for error in told.get("errors") or []
    )
    return ServiceError(
        f"the service refuses {method} {path} ({answer.status_code}): {said}"
        + (f" [{places}]" if places else ""),
        answer.status_code,
        problem,
    )
