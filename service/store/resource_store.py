"""Versions of domains and maps: added, never changed; `resources` says which is current."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, Engine, Row, delete, func, insert, select, update
from sqlalchemy.exc import IntegrityError, SQLAlchemyError

from service.coordination.ports import StoreError
from service.messages.resource import MissionUse, ResourceKind
from service.store.tables import MISSION_RESOURCES, MISSIONS, RESOURCE_VERSIONS, RESOURCES

ANY_VERSION = "*"
"""As an expectation: there is a current version, whichever."""
NO_VERSION = ""
"""As an expectation: there is no such resource yet."""


class PreconditionError(Exception):
    """The current version is not the one that the sender expects; `current` is it."""

    def __init__(self, current: str | None) -> None:
        super().__init__(f"the current version is {current}" if current else "there is none yet")
        self.current = current


class LimitReachedError(Exception):
    """More names or versions than the operator allows."""


class InUseError(Exception):
    """A mission that is not over uses it."""


@dataclass(frozen=True, slots=True)
class Content:
    """What a version consists of."""

    version: str
    body: str
    formulation: str | None = None


@dataclass(frozen=True, slots=True)
class Stored:
    """A version as it is kept; `body` is empty in listings."""

    kind: ResourceKind
    name: str
    version: str
    fleet: str
    created_at: datetime
    created_by: str
    formulation: str | None
    size_bytes: int
    body: str = ""


@dataclass(frozen=True, slots=True)
class StoreLimits:
    """How much may be kept of each kind."""

    names: int = 1000
    versions: int = 200
    """Of one name."""


class ResourceStore:
    """Domains and maps in the database; every method blocks."""

    def __init__(self, engine: Engine, limits: StoreLimits | None = None) -> None:
        self._engine = engine
        self._limits = limits or StoreLimits()

    def put(
        self,
        kind: ResourceKind,
        name: str,
        content: Content,
        *,
        fleet: str,
        by: str,
        expected: str | None = None,
    ) -> bool:
        """Makes `content` the current version; returns whether that version is new.

        Args:
            fleet: whose it is if there is no resource of this name yet.
            expected: the version that must be current, `ANY_VERSION`, `NO_VERSION`, or None.

        Raises:
            PreconditionError: it is not.
            LimitReachedError: too many are kept.
            StoreError: nothing was stored.
        """
        try:
            with self._engine.begin() as connection:
                return self._put(
                    connection, kind, name, content, fleet=fleet, by=by, expected=expected
                )
        except IntegrityError:
            # Somebody else was faster with the same name.
            raise PreconditionError(self.current(kind, name)) from None
        except SQLAlchemyError as error:
            raise StoreError(str(error.__cause__ or error)) from error

    def _put(
        self,
        connection: Connection,
        kind: ResourceKind,
        name: str,
        content: Content,
        *,
        fleet: str,
        by: str,
        expected: str | None,
    ) -> bool:
        current = _current(connection, kind, name)
        if expected is not None and not _meets(current, expected):
            raise PreconditionError(current)
        versions = connection.scalars(
            select(RESOURCE_VERSIONS.c.version).where(*_named(RESOURCE_VERSIONS.c, kind, name))
        ).all()
        is_new = content.version not in versions
        if is_new:
            self._check_limits(connection, kind, name, current, len(versions))
            connection.execute(
                insert(RESOURCE_VERSIONS).values(
                    kind=kind,
                    name=name,
                    version=content.version,
                    number=len(versions),
                    created_at=datetime.now(UTC),
                    created_by=by,
                    formulation=content.formulation,
                    size_bytes=len(content.body.encode()),
                    body=content.body,
                )
            )
        if current is None:
            connection.execute(
                insert(RESOURCES).values(kind=kind, name=name, version=content.version, fleet=fleet)
            )
        else:
            # Compared again by the database: of two writers at once, one finds nothing to change.
            changed = connection.execute(
                update(RESOURCES)
                .where(*_named(RESOURCES.c, kind, name), RESOURCES.c.version == current)
                .values(version=content.version)
            )
            if changed.rowcount != 1:
                raise PreconditionError(_current(connection, kind, name))
        return is_new

    def _check_limits(
        self, connection: Connection, kind: ResourceKind, name: str, current: str | None, kept: int
    ) -> None:
        if kept >= self._limits.versions:
            raise LimitReachedError(
                f"{kept} versions of {name!r} are kept, which is all that is allowed: "
                "delete it, or use another name"
            )
        if current is None:
            names = connection.scalar(
                select(func.count()).select_from(RESOURCES).where(RESOURCES.c.kind == kind)
            )
            if (names or 0) >= self._limits.names:
                raise LimitReachedError(
                    f"{names} {kind}s are kept, which is all that is allowed: delete one"
                )

    def current(self, kind: ResourceKind, name: str) -> str | None:
        """The version that a name means now."""
        with self._engine.connect() as connection:
            return _current(connection, kind, name)

    def find(self, kind: ResourceKind, name: str, version: str | None = None) -> list[Stored]:
        """The current version, or all whose hash begins with `version`, two at most."""
        query = _stored().where(*_named(RESOURCES.c, kind, name))
        if version is None:
            query = query.where(RESOURCE_VERSIONS.c.version == RESOURCES.c.version)
        else:
            query = query.where(RESOURCE_VERSIONS.c.version.startswith(version, autoescape=True))
        with self._engine.connect() as connection:
            return [_read(row, body=row.body) for row in connection.execute(query.limit(2))]

    def listed(self, kind: ResourceKind) -> list[Stored]:
        """The current version of everything of a kind, by name."""
        query = (
            _stored(body=False)
            .where(RESOURCES.c.kind == kind, RESOURCE_VERSIONS.c.version == RESOURCES.c.version)
            .order_by(RESOURCES.c.name)
        )
        with self._engine.connect() as connection:
            return [_read(row) for row in connection.execute(query)]

    def versions(self, kind: ResourceKind, name: str) -> list[Stored]:
        """All versions of a resource, the latest upload first."""
        query = (
            _stored(body=False)
            .where(*_named(RESOURCES.c, kind, name))
            .order_by(RESOURCE_VERSIONS.c.number.desc())
        )
        with self._engine.connect() as connection:
            return [_read(row) for row in connection.execute(query)]

    def uses(self, kind: ResourceKind, name: str) -> list[tuple[str, MissionUse]]:
        """Missions that use a resource with their fleets, the latest first."""
        used = MISSION_RESOURCES.c
        query = (
            select(
                MISSIONS.c.id, MISSIONS.c.name, MISSIONS.c.fleet, MISSIONS.c.is_over, used.version
            )
            .join(MISSIONS, MISSIONS.c.id == used.mission_id)
            .where(*_named(used, kind, name))
            .order_by(MISSIONS.c.created_at.desc(), MISSIONS.c.id)
        )
        with self._engine.connect() as connection:
            return [
                (
                    row.fleet,
                    MissionUse(
                        mission=row.id, name=row.name, version=row.version, is_over=row.is_over
                    ),
                )
                for row in connection.execute(query)
            ]

    def remove(self, kind: ResourceKind, name: str, expected: str | None = None) -> None:
        """Forgets a resource with all its versions.

        Raises:
            InUseError: a mission that is not over uses it.
            PreconditionError: the current version is not `expected`.
            StoreError: nothing was changed.
        """
        try:
            with self._engine.begin() as connection:
                current = _current(connection, kind, name)
                if expected is not None and not _meets(current, expected):
                    raise PreconditionError(current)
                used = MISSION_RESOURCES.c
                users = connection.scalars(
                    select(MISSIONS.c.id)
                    .join(MISSION_RESOURCES, MISSIONS.c.id == used.mission_id)
                    .where(*_named(used, kind, name), MISSIONS.c.is_over.is_(False))
                ).all()
                if users:
                    raise InUseError(f"{len(users)} open missions use it, {users[0]} among them")
                connection.execute(delete(RESOURCES).where(*_named(RESOURCES.c, kind, name)))
                connection.execute(
                    delete(RESOURCE_VERSIONS).where(*_named(RESOURCE_VERSIONS.c, kind, name))
                )
        except SQLAlchemyError as error:
            raise StoreError(str(error.__cause__ or error)) from error


def _named(columns: Any, kind: ResourceKind, name: str) -> Sequence[Any]:
    return columns.kind == kind, columns.name == name


def _current(connection: Connection, kind: ResourceKind, name: str) -> str | None:
    return connection.scalar(select(RESOURCES.c.version).where(*_named(RESOURCES.c, kind, name)))


def _meets(current: str | None, expected: str) -> bool:
    if expected == ANY_VERSION:
        return current is not None
    if expected == NO_VERSION:
        return current is None
    return current == expected


def _stored(*, body: bool = True) -> Any:
    columns = [
        column for column in RESOURCE_VERSIONS.c if body or column is not RESOURCE_VERSIONS.c.body
    ]
    return select(*columns, RESOURCES.c.fleet).join(
        RESOURCES,
        (RESOURCES.c.kind == RESOURCE_VERSIONS.c.kind)
        & (RESOURCES.c.name == RESOURCE_VERSIONS.c.name),
    )


def _read(row: Row[Any], body: str = "") -> Stored:
    created_at = row.created_at
    return Stored(
        kind=row.kind,
        name=row.name,
        version=row.version,
        fleet=row.fleet,
        created_at=created_at if created_at.tzinfo else created_at.replace(tzinfo=UTC),
        created_by=row.created_by,
        formulation=row.formulation,
        size_bytes=row.size_bytes,
        body=body,
    )
