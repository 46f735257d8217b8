"""Brings a database's tables to the shape that this version works with."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from sqlalchemy import Engine

from service.store.tables import METADATA


def prepare(engine: Engine) -> None:
    """Creates the tables, or migrates those that an older version made; keeps what is in them."""
    if engine.dialect.name == "sqlite" and engine.url.database in (None, "", ":memory:"):
        METADATA.create_all(engine)  # nothing older can be in memory
        return
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    config.set_main_option("path_separator", "os")
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "head")
