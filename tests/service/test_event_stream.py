"""Server-sent events: read, resumed, each once."""

import httpx
import pytest
from test_connection import connected

from service.connection import ServiceError
from service.event_stream import StreamedEvent, followed, parsed


def test_events_are_read_as_the_specification_says() -> None:
    lines = [
        ": a comment",
        "id: 1",
        "event: seen",
        "data: one",
        "data:two",
        "",
        "retry: 5",
        "",
        "data: unnamed",
        "",
        "id: 2",
        "data: cut off",
    ]
    assert list(parsed(lines)) == [
        StreamedEvent("1", "seen", "one\ntwo"),
        StreamedEvent("1", "message", "unnamed"),
    ]


def test_a_stream_that_breaks_goes_on_after_the_last_event() -> None:
    asked: list[str | None] = []

    def handler(request: httpx.Request) -> httpx.Response:
        asked.append(request.headers.get("last-event-id"))
        if len(asked) == 2:
            raise httpx.ConnectError("refused")
        first = int(asked[-1] or -1) + 1
        last = first + 2
        text = "".join(
            f"id: {n}\nevent: {'end' if n == 5 else 'x'}\ndata: {n}\n\n" for n in range(first, last)
        )
        return httpx.Response(200, text=text + f"id: {last}\ndata: cut")

    connection, _ = connected(handler)
    events = list(followed(connection, "/events", None, frozenset({"end"})))
    assert [event.data for event in events] == ["0", "1", "2", "3", "4", "5"]
    assert asked == [None, "1", "1", "3"]


def test_a_stream_that_never_comes_is_given_up() -> None:
    connection, clock = connected(lambda _: httpx.Response(200, text=""))
    with pytest.raises(ServiceError, match="the stream ended early"):
        list(followed(connection, "/events", "7", frozenset({"end"})))
    assert clock.time_s <= 60.0
    connection, _ = connected(lambda _: httpx.Response(404, json={"detail": "none"}))
    with pytest.raises(ServiceError, match="404"):
        list(followed(connection, "/events", None, frozenset({"end"})))
