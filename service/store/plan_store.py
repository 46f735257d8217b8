"""Planning requests and what came of them; this table is the only truth about a request's state."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import Engine, insert, select, update
from sqlalchemy.exc import SQLAlchemyError

from service.coordination.ports import StoreError
from service.jobs.executor import Told
from service.store.tables import PLAN_EVENTS, PLAN_REQUESTS


@dataclass(frozen=True, slots=True)
class StoredRequest:
    """A request as it is stored."""

    id: str
    client: str
    body: str
    status: str


class PlanStore:
    """Planning requests in the database; every method blocks and commits."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(
        self, identifier: str, client: str, body: str, key: str | None = None, digest: str = ""
    ) -> None:
        """Stores a new request; `key` and `digest` tell a repetition.

        Raises:
            StoreError: nothing was stored.
        """
        try:
            with self._engine.begin() as connection:
                connection.execute(
                    insert(PLAN_REQUESTS).values(
                        id=identifier,
                        client=client,
                        body=body,
                        status="queued",
                        created_at=datetime.now(UTC),
                        idempotency_key=key,
                        body_digest=digest or None,
                    )
                )
        except SQLAlchemyError as error:
            raise StoreError(str(error.__cause__ or error)) from error

    def created_under(self, client: str, key: str) -> tuple[str, str] | None:
        """Id and digest of the request that a client made under a key."""
        query = select(PLAN_REQUESTS.c.id, PLAN_REQUESTS.c.body_digest).where(
            PLAN_REQUESTS.c.client == client, PLAN_REQUESTS.c.idempotency_key == key
        )
        with self._engine.connect() as connection:
            row = connection.execute(query).one_or_none()
        return None if row is None else (row.id, row.body_digest or "")

    def set_status(self, identifier: str, status: str) -> None:
        """Stores that a request runs, or waits again; its end is stored by `tell`."""
        with self._engine.begin() as connection:
            connection.execute(
                update(PLAN_REQUESTS).where(PLAN_REQUESTS.c.id == identifier).values(status=status)
            )

    def tell(self, identifier: str, number: int, told: Told) -> None:
        """Stores what a worker told; the last of it ends the request."""
        with self._engine.begin() as connection:
            connection.execute(
                insert(PLAN_EVENTS).values(
                    request_id=identifier, number=number, body=json.dumps(told)
                )
            )
            if told["kind"] in ("finished", "failed", "canceled"):
                connection.execute(
                    update(PLAN_REQUESTS)
                    .where(PLAN_REQUESTS.c.id == identifier)
                    .values(status=told["kind"])
                )

    def find(self, identifier: str) -> tuple[StoredRequest, Sequence[Told]] | None:
        """A request and all that was told about it."""
        with self._engine.connect() as connection:
            row = connection.execute(
                select(PLAN_REQUESTS).where(PLAN_REQUESTS.c.id == identifier)
            ).one_or_none()
            if row is None:
                return None
            told = connection.scalars(
                select(PLAN_EVENTS.c.body)
                .where(PLAN_EVENTS.c.request_id == identifier)
                .order_by(PLAN_EVENTS.c.number)
            )
            request = StoredRequest(row.id, row.client, row.body, row.status)
            return request, [json.loads(body) for body in told]

    def unfinished(self) -> list[StoredRequest]:
        """Requests that were accepted and have not ended, oldest first."""
        with self._engine.connect() as connection:
            rows = connection.execute(
                select(PLAN_REQUESTS)
                .where(PLAN_REQUESTS.c.status.in_(("queued", "running")))
                .order_by(PLAN_REQUESTS.c.created_at, PLAN_REQUESTS.c.id)
            )
            return [StoredRequest(row.id, row.client, row.body, row.status) for row in rows]
