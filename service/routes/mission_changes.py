"""What people change in a mission that is under way: robots, targets, instructions."""

import uuid
from collections.abc import Callable
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Depends, Response

from service.access import needs
from service.coordination.admission import instruction_faults, robot_faults, target_faults
from service.coordination.coordinator import Coordinator, OverError
from service.coordination.events import (
    Event,
    InstructionGiven,
    InstructionWithdrawn,
    RobotJoined,
    RobotLeft,
    TargetAdded,
    TargetRemoved,
)
from service.coordination.mission import Mission
from service.coordination.ports import KeyReusedError, StoreError
from service.coordination.views import mission_detail
from service.json_body import described, json_body
from service.messages.instruction import InstructionBody
from service.messages.mission import RobotMessage, TargetMessage
from service.messages.plan import MissionDetail
from service.problem_details import invalid, not_found
from service.routes.missions import (
    CoordinatorOf,
    IdempotencyKey,
    key_reused,
    over,
    unavailable,
    wait_s,
)

ROUTER = APIRouter(
    prefix="/v1/missions/{mission_id}",
    tags=["people in the loop"],
    dependencies=[Depends(needs("edit"))],
)
BODIES = (RobotMessage, TargetMessage, InstructionBody)
_KEYS = uuid.UUID("7b1f0c66-4f0e-4f0b-9d55-6a1c6f3d2a10")
"""Namespace of ids made from idempotency keys."""
WaitS = Annotated[float, Depends(wait_s)]


async def changed(
    found: Coordinator, draft: Callable[[Mission], Event | None], wait: float
) -> MissionDetail:
    """The mission after a change, and after the replan it gives cause for if the sender waits."""
    try:
        await found.change(draft)
    except OverError as error:
        raise over(error) from None
    except StoreError as error:
        raise unavailable(error) from None
    if wait > 0.0:
        await found.settle(wait)
    return mission_detail(found.mission)


@ROUTER.post("/robots", status_code=HTTPStatus.CREATED, openapi_extra=described(RobotMessage))
async def join(
    found: CoordinatorOf,
    body: Annotated[RobotMessage, Depends(json_body(RobotMessage))],
    wait: WaitS,
) -> MissionDetail:
    """A robot joins the mission, or comes back after it had left."""

    def draft(mission: Mission) -> Event:
        if faults := robot_faults(mission, body, found.grid):
            raise invalid(faults)
        return RobotJoined(time_s=mission.time_s, robot=body)

    return await changed(found, draft, wait)


@ROUTER.delete("/robots/{robot_id}")
async def leave(found: CoordinatorOf, robot_id: str, wait: WaitS) -> MissionDetail:
    """A robot leaves the mission; it is planned without from now on."""

    def draft(mission: Mission) -> Event | None:
        robot = mission.robots.get(robot_id)
        if robot is None:
            raise not_found("robot", robot_id)
        return None if robot.left else RobotLeft(time_s=mission.time_s, robot=robot_id)

    return await changed(found, draft, wait)


@ROUTER.post("/targets", status_code=HTTPStatus.CREATED, openapi_extra=described(TargetMessage))
async def add_target(
    found: CoordinatorOf,
    body: Annotated[TargetMessage, Depends(json_body(TargetMessage))],
    wait: WaitS,
) -> MissionDetail:
    """There is one more place to visit."""

    def draft(mission: Mission) -> Event:
        if faults := target_faults(mission, body, found.grid):
            raise invalid(faults)
        return TargetAdded(time_s=mission.time_s, target=body)

    return await changed(found, draft, wait)


@ROUTER.delete("/targets/{target_id}")
async def remove_target(found: CoordinatorOf, target_id: str, wait: WaitS) -> MissionDetail:
    """A target need not be visited any more."""

    def draft(mission: Mission) -> Event | None:
        target = mission.targets.get(target_id)
        if target is None:
            raise not_found("target", target_id)
        if not target.is_open:
            return None
        return TargetRemoved(time_s=mission.time_s, target=target_id)

    return await changed(found, draft, wait)


@ROUTER.post(
    "/instructions", status_code=HTTPStatus.CREATED, openapi_extra=described(InstructionBody)
)
async def instruct(
    found: CoordinatorOf,
    body: Annotated[InstructionBody, Depends(json_body(InstructionBody))],
    wait: WaitS,
    response: Response,
    idempotency_key: IdempotencyKey = None,
) -> MissionDetail:
    """Pins or forbids an assignment, sets a priority or a deadline, takes a robot over."""
    # The same key gives the same id, so that a repetition finds what it is about.
    scope = f"{found.mission.id}/{idempotency_key}"
    identifier = (uuid.uuid4() if idempotency_key is None else uuid.uuid5(_KEYS, scope)).hex[:12]

    def draft(mission: Mission) -> Event | None:
        given = mission.instructions.get(identifier)
        if given is not None:
            if given.instruction != body.root:
                raise key_reused(KeyReusedError("this key was used for another instruction"))
            return None
        if faults := instruction_faults(mission, body.root):
            raise invalid(faults)
        return InstructionGiven(time_s=mission.time_s, id=identifier, instruction=body.root)

    response.headers["Location"] = f"/v1/missions/{found.mission.id}/instructions/{identifier}"
    return await changed(found, draft, wait)


@ROUTER.delete("/instructions/{instruction_id}")
async def withdraw(found: CoordinatorOf, instruction_id: str, wait: WaitS) -> MissionDetail:
    """An instruction no longer counts; a robot that was taken over is handed back."""

    def draft(mission: Mission) -> Event:
        if instruction_id not in mission.instructions:
            raise not_found("instruction", instruction_id)
        return InstructionWithdrawn(time_s=mission.time_s, id=instruction_id)

    return await changed(found, draft, wait)
