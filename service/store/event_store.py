"""The event log. `append` returns when the events are on disk, and not before.

One writer thread commits what several missions have to say in one transaction: a report costs a
share of an fsync, not one of its own.
"""

import asyncio
import queue
import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime

from sqlalchemy import Connection, Engine, func, insert, select, update
from sqlalchemy.exc import SQLAlchemyError

from service.coordination.events import Event, MissionClosed, MissionCreated, from_json, to_json
from service.coordination.ports import StoreError
from service.store.tables import EVENTS, MISSION_RESOURCES, MISSIONS

BATCH = 256
"""Appends committed together at most."""


@dataclass(slots=True)
class _Append:
    mission_id: str
    first_number: int
    events: Sequence[Event]
    loop: asyncio.AbstractEventLoop
    done: asyncio.Future[None] = field(init=False)

    def __post_init__(self) -> None:
        self.done = self.loop.create_future()

    def resolve(self, error: Exception | None) -> None:
        def settle() -> None:
            if self.done.cancelled():
                return
            if error is None:
                self.done.set_result(None)
            else:
                self.done.set_exception(error)

        with suppress(RuntimeError):  # nobody waits any more: the loop is closed
            self.loop.call_soon_threadsafe(settle)


class EventStore:
    """Missions and their events in one database."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._queue: queue.SimpleQueue[_Append | None] = queue.SimpleQueue()
        self._writer = threading.Thread(target=self._write, name="event-writer", daemon=True)
        self._writer.start()

    async def append(self, mission_id: str, first_number: int, events: Sequence[Event]) -> None:
        """Stores consecutive events of a mission, numbered from `first_number`.

        Raises:
            StoreError: nothing was written (disk full, database gone, number taken).
        """
        request = _Append(mission_id, first_number, events, asyncio.get_running_loop())
        self._queue.put(request)
        # A client that hangs up must not leave the mission behind its own log.
        await asyncio.shield(request.done)

    def open_missions(self) -> list[str]:
        """Ids of the missions that are not over, oldest first."""
        query = (
            select(MISSIONS.c.id)
            .where(MISSIONS.c.is_over.is_(False))
            .order_by(MISSIONS.c.created_at, MISSIONS.c.id)
        )
        with self._engine.connect() as connection:
            return list(connection.scalars(query))

    def events(self, mission_id: str, first_number: int = 0) -> Iterator[Event]:
        """A mission's events in order; none if there is no such mission."""
        for _, event in self.numbered(mission_id, first_number):
            yield event

    def numbered(
        self, mission_id: str, first_number: int = 0, limit: int | None = None
    ) -> Iterator[tuple[int, Event]]:
        """A mission's events with their numbers, from `first_number`."""
        query = (
            select(EVENTS.c.number, EVENTS.c.body)
            .where(EVENTS.c.mission_id == mission_id, EVENTS.c.number >= first_number)
            .order_by(EVENTS.c.number)
            .limit(limit)
        )
        with self._engine.connect() as connection:
            for number, body in connection.execute(query):
                yield number, from_json(body)

    def created_under(self, idempotency_key: str) -> tuple[str, str] | None:
        """Mission id and body digest of the mission created under a key."""
        query = select(MISSIONS.c.id, MISSIONS.c.body_digest).where(
            MISSIONS.c.idempotency_key == idempotency_key
        )
        with self._engine.connect() as connection:
            row = connection.execute(query).one_or_none()
        return None if row is None else (row.id, row.body_digest)

    def listed(self, limit: int) -> list[str]:
        """Ids of missions, the latest first."""
        query = (
            select(MISSIONS.c.id).order_by(MISSIONS.c.created_at.desc(), MISSIONS.c.id).limit(limit)
        )
        with self._engine.connect() as connection:
            return list(connection.scalars(query))

    def is_writable(self) -> bool:
        """Whether the database answers."""
        try:
            with self._engine.connect() as connection:
                connection.execute(select(func.count()).select_from(MISSIONS))
        except SQLAlchemyError:
            return False
        return True

    def close(self) -> None:
        """Writes what is queued and lets go of the database."""
        self._queue.put(None)
        self._writer.join()
        self._engine.dispose()

    def _write(self) -> None:
        running = True
        while running:
            batch: list[_Append] = []
            request = self._queue.get()
            while request is not None:
                batch.append(request)
                if len(batch) == BATCH or self._queue.empty():
                    break
                request = self._queue.get()
            running = request is not None
            self._commit(batch)

    def _commit(self, batch: Sequence[_Append]) -> None:
        if not batch:
            return
        try:
            with self._engine.begin() as connection:
                for request in batch:
                    self._insert(connection, request)
        except SQLAlchemyError as error:
            if len(batch) > 1:
                # One bad append must not take the others with it.
                for request in batch:
                    self._commit([request])
            else:
                batch[0].resolve(StoreError(str(error.__cause__ or error)))
        else:
            for request in batch:
                request.resolve(None)

    @staticmethod
    def _insert(connection: Connection, request: _Append) -> None:
        now = datetime.now(UTC)
        for event in request.events:
            if isinstance(event, MissionCreated):
                connection.execute(
                    insert(MISSIONS).values(
                        id=event.id,
                        name=event.request.name,
                        fleet=event.request.fleet,
                        domain=event.request.domain,
                        is_over=False,
                        idempotency_key=event.idempotency_key,
                        body_digest=event.body_digest,
                        created_at=now,
                    )
                )
                if event.resources:
                    used = [one.model_dump() for one in event.resources]
                    connection.execute(
                        insert(MISSION_RESOURCES), [{"mission_id": event.id, **u} for u in used]
                    )
            elif isinstance(event, MissionClosed):
                connection.execute(
                    update(MISSIONS).where(MISSIONS.c.id == request.mission_id).values(is_over=True)
                )
        connection.execute(
            insert(EVENTS),
            [
                {
                    "mission_id": request.mission_id,
                    "number": request.first_number + offset,
                    "kind": event.kind,
                    "recorded_at": now,
                    "body": to_json(event),
                }
                for offset, event in enumerate(request.events)
            ],
        )
