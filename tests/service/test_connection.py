"""Patience: what is sent again, what is not, and what is said in the end."""

from collections.abc import Callable

import httpx
import pytest

from service.connection import Connection, Patience, ServiceError


class Clock:
    """A clock that only sleeping moves."""

    def __init__(self) -> None:
        self.time_s = 0.0

    def sleep(self, seconds: float) -> None:
        self.time_s += seconds

    def now(self) -> float:
        return self.time_s


Handler = Callable[[httpx.Request], httpx.Response]


def connected(handler: Handler, key: str | None = None) -> tuple[Connection, Clock]:
    clock = Clock()
    http = httpx.Client(transport=httpx.MockTransport(handler), base_url="http://service")
    return Connection(http, Patience(), key, clock.sleep, clock.now), clock


class Answers:
    """One answer, or trouble, after the other; the last for ever."""

    def __init__(self, *answers: int | Exception) -> None:
        self.answers = list(answers)
        self.seen: list[httpx.Request] = []

    def __call__(self, request: httpx.Request) -> httpx.Response:
        self.seen.append(request)
        answer = self.answers[min(len(self.seen), len(self.answers)) - 1]
        if isinstance(answer, Exception):
            raise answer
        headers = {"Retry-After": "3"} if answer == 503 else {}
        return httpx.Response(answer, json={"detail": "told"}, headers=headers)


def test_a_lost_answer_is_asked_for_again_with_the_same_request() -> None:
    answers = Answers(httpx.ReadTimeout("lost"), 503, 500, 200)
    connection, clock = connected(answers, key="mk_x")
    connection.send("POST", "/reports", content="{}", wait_s=5)
    assert len({(request.content, tuple(request.headers.items())) for request in answers.seen}) == 1
    assert answers.seen[0].headers["prefer"] == "wait=5"
    assert answers.seen[0].headers["authorization"] == "Bearer mk_x"
    assert connection.retries == 3
    assert clock.time_s >= 3.0


@pytest.mark.parametrize(
    ("trouble", "repeated"),
    [
        (httpx.ConnectError("refused"), True),
        (503, True),
        (429, True),
        (httpx.ReadTimeout("lost"), False),
        (500, False),
    ],
)
def test_what_must_not_be_done_twice_is_sent_again_only_if_it_was_not_done(
    trouble: int | Exception, *, repeated: bool
) -> None:
    answers = Answers(trouble, 200)
    connection, _ = connected(answers)
    if repeated:
        connection.send("POST", "/robots", repeatable=False)
        assert len(answers.seen) == 2
    else:
        with pytest.raises(ServiceError):
            connection.send("POST", "/robots", repeatable=False)
        assert len(answers.seen) == 1


def test_a_service_that_stays_away_is_given_up_with_a_remedy() -> None:
    connection, clock = connected(Answers(httpx.ConnectError("refused")))
    with pytest.raises(ServiceError, match="start it with `marsupial serve`"):
        connection.send("GET", "/")
    assert 30.0 < clock.time_s <= 60.0


def test_a_refusal_says_where_the_body_is_wrong() -> None:
    problem = {
        "detail": "the mission is malformed",
        "errors": [{"location": "/robots/0/pose", "message": "is inside a wall"}],
    }
    connection, _ = connected(lambda _: httpx.Response(422, json=problem))
    with pytest.raises(ServiceError, match=r"422\).*/robots/0/pose: is inside a wall") as caught:
        connection.send("POST", "/v1/missions")
    assert caught.value.status == 422
    assert caught.value.problem == problem
    connection, _ = connected(lambda _: httpx.Response(403, text="no"))
    with pytest.raises(ServiceError, match=r"403\): no"):
        connection.send("GET", "/")
