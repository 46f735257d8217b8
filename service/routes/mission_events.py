"""A mission's events as they happen (server-sent events, WHATWG HTML, section 9.2)."""

from collections.abc import AsyncIterator
from typing import Annotated

import anyio.to_thread
from fastapi import APIRouter, Depends, Header, Query, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent

from service.access import needs
from service.coordination.registry import Missions
from service.draining import Draining
from service.problem_details import invalid
from service.routes.missions import CoordinatorOf, missions

ROUTER = APIRouter(
    prefix="/v1/missions/{mission_id}",
    tags=["missions"],
    dependencies=[Depends(needs("operate"))],
)
BATCH = 200
"""Events read from the log at once."""
SILENCE_S = 15.0
"""How long to wait for news before looking whether the mission is over."""


async def first_wanted(last_event_id: Annotated[str | None, Header()] = None) -> int:
    """The number of the first event a client has not seen."""
    if last_event_id is None:
        return 0
    if not last_event_id.isdecimal() or len(last_event_id) > 15:
        raise invalid([("/Last-Event-ID", "is not the id of an event of this mission")])
    return int(last_event_id) + 1


async def draining_of(request: Request) -> Draining:
    """Whether the service has been asked to stop."""
    found: Draining = request.app.state.draining
    return found


@ROUTER.get("/events", response_class=EventSourceResponse)
async def events(
    found: CoordinatorOf,
    all_missions: Annotated[Missions, Depends(missions)],
    wanted: Annotated[int, Depends(first_wanted)],
    draining: Annotated[Draining, Depends(draining_of)],
    follow: Annotated[bool, Query(description="Whether to wait for more events.")] = True,
) -> AsyncIterator[ServerSentEvent]:
    """Everything that happened to the mission and happens from now on; ends with the mission.

    With `follow=false` it ends with what has happened so far.

    Ids are the numbers of the events: a client that lost the connection goes on after the
    `Last-Event-ID` it sends.
    """
    mission_id = found.mission.id
    while True:
        batch = found.latest(wanted) or await anyio.to_thread.run_sync(
            all_missions.events, mission_id, wanted, BATCH
        )
        for number, event in batch:
            yield ServerSentEvent(
                id=str(number), event=event.kind, raw_data=event.model_dump_json()
            )
            wanted = number + 1
        if len(batch) == BATCH:
            continue
        if (found.mission.is_over or not follow) and wanted >= found.mission.events:
            return
        if draining.begun:
            return  # the client goes on where it was with the next service
        await found.news(wanted, SILENCE_S)
