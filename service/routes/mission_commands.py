"""A mission's commands over a WebSocket: pushed when they change; reports may come the same way.

Frames are JSON objects with a `kind`: the service sends `commands` (as in the answer to a report)
and `problem` (RFC 9457), the fleet sends reports as they are, and each is answered. Only the latest
commands are sent: a slow reader misses nothing that still holds.
"""

import asyncio
from http import HTTPStatus

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import BaseModel, ValidationError

from service.access import Caller, Gate
from service.coordination.coordinator import Coordinator, ReportRefusedError
from service.coordination.ports import StoreError
from service.coordination.registry import Missions
from service.messages.report import Report
from service.problem_details import ProblemError, from_validation, invalid, not_found, response
from service.routes.missions import unavailable

ROUTER = APIRouter()
SILENCE_S = 15.0
"""How long to wait for news before looking whether the mission is over."""
NORMAL_CLOSURE = 1000


@ROUTER.websocket("/v1/missions/{mission_id}/commands")
async def commands(socket: WebSocket, mission_id: str) -> None:
    """Commands as they change, until the mission ends."""
    try:
        caller, found = await _admitted(socket, mission_id)
    except ProblemError as problem:
        await socket.send_denial_response(response(problem))
        return
    await socket.accept()
    conversation = Conversation(socket, found, caller)
    tasks = {
        asyncio.create_task(conversation.push()),
        asyncio.create_task(conversation.take_in()),
    }
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            task.result()
        await socket.close(NORMAL_CLOSURE)
    except (WebSocketDisconnect, RuntimeError):
        pass  # the other side has gone
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _admitted(socket: WebSocket, mission_id: str) -> tuple[Caller, Coordinator]:
    """Whoever asks, and the mission.

    Raises:
        ProblemError: 401, 403 or 404.
    """
    gate: Gate = socket.app.state.gate
    caller = gate.caller(socket)
    if "read" not in caller.scopes:
        raise ProblemError(
            HTTPStatus.FORBIDDEN, "forbidden", f"the key {caller.name!r} lacks scope 'read'"
        )
    missions: Missions = socket.app.state.missions
    found = await missions.find(mission_id)
    if found is None or not caller.reaches(found.mission.request.fleet):
        raise not_found("mission", mission_id)
    return caller, found


class Conversation:
    """One socket: frames go out one at a time."""

    def __init__(self, socket: WebSocket, found: Coordinator, caller: Caller) -> None:
        self._socket = socket
        self._found = found
        self._caller = caller
        self._sending = asyncio.Lock()

    async def push(self) -> None:
        """Sends the commands whenever they change, until the mission is over."""
        found, told = self._found, None
        while True:
            events, is_over = found.mission.events, found.mission.is_over
            answer = found.answer()
            fresh = (
                answer.mission.status,
                answer.mission.revision,
                [c.id for c in answer.commands],
            )
            if fresh != told:
                await self._send("commands", answer)
                told = fresh
            if is_over or self._socket.app.state.draining.begun:
                return
            await found.news(events, SILENCE_S)

    async def take_in(self) -> None:
        """Answers each report with the commands in force, or with what is wrong with it."""
        while True:
            text = await self._socket.receive_text()
            try:
                await self._report(text)
            except ProblemError as problem:
                await self._send("problem", problem.problem())
            else:
                await self._send("commands", self._found.answer())

    async def _send(self, kind: str, body: BaseModel) -> None:
        frame = {"kind": kind, **body.model_dump(mode="json", exclude_none=kind == "problem")}
        async with self._sending:
            await self._socket.send_json(frame)

    async def _report(self, text: str) -> None:
        if "operate" not in self._caller.scopes:
            raise ProblemError(
                HTTPStatus.FORBIDDEN,
                "forbidden",
                f"the key {self._caller.name!r} lacks scope 'operate'",
            )
        limit = self._socket.app.state.settings.max_body_bytes
        if len(text) > limit:
            raise ProblemError(
                HTTPStatus(413), "body-too-large", f"the report is larger than {limit} bytes"
            )
        try:
            await self._found.report(Report.model_validate_json(text))
        except ValidationError as error:
            raise from_validation(error) from None
        except ReportRefusedError as error:
            raise invalid(error.faults) from None
        except StoreError as error:
            raise unavailable(error) from None
