"""Database connections, set up so that a commit is on disk when it returns."""

from typing import Any

from sqlalchemy import Engine, create_engine, event
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, NoSuchModuleError
from sqlalchemy.pool import ConnectionPoolEntry, QueuePool


class DatabaseUrlError(ValueError):
    """A database URL that cannot be used."""


def connect(url: str) -> Engine:
    """An engine for a SQLite file (WAL, synchronous=FULL) or a PostgreSQL server.

    Raises:
        DatabaseUrlError: the URL is malformed or its driver is missing.
    """
    try:
        parsed = make_url(url)
        if parsed.get_backend_name() == "sqlite":
            return _sqlite(url, in_memory=parsed.database in (None, "", ":memory:"))
        return create_engine(url, pool_pre_ping=True)
    except (ArgumentError, NoSuchModuleError, ModuleNotFoundError) as error:
        raise DatabaseUrlError(
            f"{url!r} is no database this server can open: {error}; "
            "write sqlite:///FILE or postgresql+psycopg://USER@HOST/NAME"
        ) from None


def _sqlite(url: str, *, in_memory: bool) -> Engine:
    arguments: dict[str, Any] = {"check_same_thread": False, "timeout": 10.0}
    if in_memory:
        # The one connection is the database. Threads take turns at it: a reader that gives back a
        # connection rolls back what is open on it, be it another thread's transaction.
        engine = create_engine(
            url, connect_args=arguments, poolclass=QueuePool, pool_size=1, max_overflow=0
        )
    else:
        engine = create_engine(url, connect_args=arguments)

    @event.listens_for(engine, "connect")
    def _(connection: Any, _: ConnectionPoolEntry) -> None:
        cursor = connection.cursor()
        cursor.execute("PRAGMA journal_mode=WAL")
        cursor.execute("PRAGMA synchronous=FULL")
        cursor.execute("PRAGMA foreign_keys=ON")
        cursor.close()

    return engine
