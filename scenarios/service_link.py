"""The service's own client as what the simulated fleet needs: the simulator knows neither."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, TypeVar

import httpx
from pydantic import BaseModel, ValidationError

from service.client import Client
from service.connection import Connection, ServiceError
from service.messages.mission import MissionRequest
from service.messages.report import Report
from simulator.fleet_client import FleetClientError

M = TypeVar("M", bound=BaseModel)
PLANNING_WAIT_S = 30.0
"""How long an answer may wait for replanning, so that planning takes no simulated time."""


class ServiceLink:
    """The simulator's `CoordinationService`, over HTTP."""

    def __init__(self, http: httpx.Client, key: str | None = None) -> None:
        self.client = Client(Connection(http, key=key))

    @property
    def retries(self) -> int:
        """Requests that had to be sent again."""
        return self.client.connection.retries

    def create_mission(self, request: Mapping[str, Any]) -> str:
        """Creates a mission and returns its id.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        try:
            return self.client.create_mission(_message(MissionRequest, request)).id
        except ServiceError as error:
            raise FleetClientError(str(error)) from None

    def report(self, mission: str, report: Mapping[str, Any]) -> Mapping[str, Any]:
        """Sends a report until it is answered; the answer comes after the replan.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        try:
            answer = self.client.report(mission, _message(Report, report), wait_s=PLANNING_WAIT_S)
        except ServiceError as error:
            raise FleetClientError(str(error)) from None
        return answer.model_dump()


def _message(model: type[M], body: Mapping[str, Any]) -> M:
    try:
        return model.model_validate_json(json.dumps(body))
    except ValidationError as error:
        raise FleetClientError(f"this does not follow the fleet protocol: {error}") from None
