"""Server-sent events as a client reads them (WHATWG HTML, section 9.2.6), resumed if they break."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import httpx

from service.connection import Connection


@dataclass(frozen=True, slots=True)
class StreamedEvent:
    """One event of a stream."""

    id: str
    kind: str
    data: str


def parsed(lines: Iterable[str]) -> Iterator[StreamedEvent]:
    """The events in the lines of a stream; one that was cut off at the end is none."""
    identifier, kind, data = "", "message", list[str]()
    for line in lines:
        if not line:
            if data:
                yield StreamedEvent(identifier, kind, "\n".join(data))
            kind, data = "message", []
            continue
        name, _, value = line.partition(":")
        value = value.removeprefix(" ")
        match name:
            case "id":
                identifier = value
            case "event":
                kind = value
            case "data":
                data.append(value)


def followed(
    connection: Connection, path: str, last: str | None, ends: frozenset[str]
) -> Iterator[StreamedEvent]:
    """Events after `last`, each once, until one of the kinds in `ends`.

    A connection that breaks is made again and goes on after the last event that arrived.

    Raises:
        ServiceError: refused, or the service stays away.
    """
    seen = last
    waiting = connection.waiting("GET", path)
    while True:
        headers = {"Accept": "text/event-stream"}
        if seen is not None:
            headers["Last-Event-ID"] = seen
        try:
            with connection.stream(path, headers) as answer:
                for event in parsed(answer.iter_lines()):
                    seen = event.id or seen
                    yield event
                    if event.kind in ends:
                        return
                    waiting = connection.waiting("GET", path)
            trouble = "the stream ended early"
        except httpx.TransportError as error:
            trouble = f"{type(error).__name__}: {error}".strip(": ")
        waiting.pause(trouble)
