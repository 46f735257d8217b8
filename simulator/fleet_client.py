"""The fleet's side of the fleet protocol (docs/fleet-protocol.md): plain HTTP, nothing else.

Any `httpx.Client` will do: one with a `base_url` over a socket, or starlette's `TestClient`, which
is one that calls the service in the same process.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import httpx

from simulator.fleet_scenario import Point


class FleetClientError(RuntimeError):
    """The service cannot be reached, or refuses; the message says what to do."""


@dataclass(frozen=True, slots=True)
class Patience:
    """How long a client keeps trying; all in wall-clock time."""

    first_wait_s: float = 0.1
    longest_wait_s: float = 2.0
    give_up_after_s: float = 60.0
    planning_wait_s: float = 30.0
    """How long an answer may wait for replanning, so that planning takes no simulated time."""


@dataclass(frozen=True, slots=True)
class Command:
    """A robot's current order."""

    id: str
    robot: str
    kind: str
    location: str | None = None
    partner: str | None = None
    path_m: tuple[Point, ...] = ()
    expected_duration_s: float | None = None


@dataclass(frozen=True, slots=True)
class MissionState:
    """What the service says of the mission in an answer."""

    status: str
    revision: int
    targets_left: int
    replans: int


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to a report."""

    mission: MissionState
    commands: tuple[Command, ...]


@dataclass(slots=True)
class FleetClient:
    """Speaks for one fleet in one mission; survives restarts of the service."""

    http: httpx.Client
    patience: Patience = field(default_factory=Patience)
    sleep: Callable[[float], None] = time.sleep
    now: Callable[[], float] = time.monotonic
    mission: str = ""
    sequence: int = 0
    retries: int = 0
    """requests that had to be sent again"""

    def create_mission(self, request: Mapping[str, Any]) -> str:
        """Creates the mission and returns its id.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        answer = self._send("POST", "/v1/missions", request)
        self.mission = str(answer["id"])
        return self.mission

    def report(
        self,
        time_s: float,
        robots: Sequence[Mapping[str, Any]],
        blockades: Sequence[Mapping[str, Any]] = (),
        finished: Sequence[Mapping[str, str]] = (),
        failed: Sequence[Mapping[str, str]] = (),
    ) -> Answer:
        """Reports and returns the commands; a lost answer is asked for again, same sequence number.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        body = {
            "sequence": self.sequence,
            "time_s": time_s,
            "robots": list(robots),
            "blockades": list(blockades),
            "finished": list(finished),
            "failed": list(failed),
        }
        answer = self._send("POST", f"/v1/missions/{self.mission}/reports", body)
        self.sequence += 1
        return _read_answer(answer)

    def get(self, part: str = "") -> dict[str, Any]:
        """The mission, or its `plan` or `map`."""
        return self._send("GET", f"/v1/missions/{self.mission}" + (f"/{part}" if part else ""))

    def _send(
        self, method: str, path: str, body: Mapping[str, Any] | None = None
    ) -> dict[str, Any]:
        begin_s, wait_s = self.now(), self.patience.first_wait_s
        headers = {"Prefer": f"wait={self.patience.planning_wait_s:g}"}
        while True:
            trouble, asked_s = "", 0.0
            try:
                response = self.http.request(
                    method,
                    path,
                    json=body,
                    headers=headers,
                    timeout=self.patience.planning_wait_s + 10.0,
                )
            except httpx.TransportError as error:
                trouble = f"{type(error).__name__}: {error}".strip(": ")
            else:
                if response.is_success:
                    return dict(response.json())
                if response.status_code < 500 and response.status_code not in (408, 429):
                    raise FleetClientError(_refusal(method, path, response))
                trouble = f"status {response.status_code}"
                asked_s = _retry_after_s(response)
            wait_s = max(wait_s, asked_s)
            if self.now() - begin_s + wait_s > self.patience.give_up_after_s:
                raise FleetClientError(
                    f"the service at {self.http.base_url} has not answered {method} {path} for "
                    f"{self.patience.give_up_after_s:g} s ({trouble}); start it with "
                    "`marsupial serve` or check the address"
                )
            self.retries += 1
            self.sleep(wait_s)
            wait_s = min(2.0 * wait_s, self.patience.longest_wait_s)


def _retry_after_s(response: httpx.Response) -> float:
    try:
        return max(0.0, float(response.headers.get("Retry-After", "0")))
    except ValueError:
        return 0.0


def _refusal(method: str, path: str, response: httpx.Response) -> str:
    try:
        problem = response.json()
    except ValueError:
        problem = {}
    if not isinstance(problem, dict):
        problem = {}
    said = str(problem.get("detail") or problem.get("title") or response.text[:200])
    places = "; ".join(
        f"{error.get('location')}: {error.get('message')}" for error in problem.get("errors", [])
    )
    return f"the service refuses {method} {path} ({response.status_code}): {said}" + (
        f" [{places}]" if places else ""
    )


def _read_answer(answer: Mapping[str, Any]) -> Answer:
    try:
        mission = answer["mission"]
        state = MissionState(
            status=str(mission["status"]),
            revision=int(mission["revision"]),
            targets_left=int(mission["targets_left"]),
            replans=int(mission["replans"]),
        )
        return Answer(state, tuple(_read_command(command) for command in answer["commands"]))
    except (KeyError, TypeError, ValueError) as error:
        raise FleetClientError(
            f"the service's answer does not follow the fleet protocol: {error!r}"
        ) from None


def _read_command(command: Mapping[str, Any]) -> Command:
    duration_s = command.get("expected_duration_s")
    return Command(
        id=str(command["id"]),
        robot=str(command["robot"]),
        kind=str(command["kind"]),
        location=command.get("location"),
        partner=command.get("partner"),
        path_m=tuple((float(x), float(y)) for x, y in command.get("path_m") or ()),
        expected_duration_s=None if duration_s is None else float(duration_s),
    )
