"""Where a mission's events come from: a database, or a service."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, SQLAlchemyError

from scenarios.exit_codes import CommandError
from service.client import Client, ServiceError
from service.coordination.events import Event, MissionCreated
from service.store.engine import DatabaseUrlError, connect
from service.store.event_store import EventStore

LATEST = "latest"
"""Means the mission that was created last."""
MOST_MISSIONS = 100_000


def events_of(
    mission: str, *, db: str | None = None, service: str | None = None, key: str | None = None
) -> list[Event]:
    """All events of a mission; its id may be cut off, or be `latest`.

    Raises:
        CommandError: there is no such mission, or nobody to ask.
    """
    if service is not None:
        return _from_service(mission, service, key)
    return _from_database(mission, db or "sqlite:///marsupial.sqlite")


def _from_service(mission: str, address: str, key: str | None) -> list[Event]:
    client = Client.at(address, key=key)
    try:
        known = [one.id for one in client.missions(limit=1000)]
        return [event for _, event in client.log(chosen(mission, known))]
    except ServiceError as error:
        raise CommandError(str(error)) from None
    finally:
        client.close()


def _from_database(mission: str, url: str) -> list[Event]:
    try:
        parsed = make_url(url)
    except ArgumentError:
        parsed = None
    if parsed is not None and parsed.get_backend_name() == "sqlite":
        from pathlib import Path

        # SQLite would make an empty file of that name.
        if parsed.database and not Path(parsed.database).exists():
            raise CommandError(
                f"there is no database {parsed.database}: give --db URL, the one that "
                "`marsupial serve` was started with, or --service ADDRESS"
            )
    try:
        store = EventStore(connect(url))
    except DatabaseUrlError as error:
        raise CommandError(str(error)) from None
    try:
        return list(store.events(chosen(mission, store.listed(MOST_MISSIONS))))
    except SQLAlchemyError as error:
        reason = str(error.__cause__ or error)
        raise CommandError(f"{url} holds no missions that can be read: {reason}") from None
    finally:
        store.close()


def chosen(mission: str, known: Sequence[str]) -> str:
    """The id that is meant; `known` begins with the latest.

    Raises:
        CommandError: none, or more than one.
    """
    if not known:
        raise CommandError("there is no mission yet")
    if mission == LATEST:
        return known[0]
    meant = [one for one in known if one.startswith(mission)]
    if len(meant) == 1 or mission in meant:
        return mission if mission in meant else meant[0]
    if meant:
        raise CommandError(f"{len(meant)} missions begin with {mission!r}: write more of the id")
    raise CommandError(f"there is no mission {mission!r}; the latest are " + ", ".join(known[:5]))


def creation(events: Sequence[Event]) -> MissionCreated:
    """The first event of a mission."""
    first = events[0]
    if not isinstance(first, MissionCreated):
        raise CommandError("this log does not begin with the creation of a mission")
    return first
