"""The store on SQLite files and on PostgreSQL: migrations, durability, broken connections."""

from concurrent.futures import ThreadPoolExecutor, wait
from datetime import UTC, datetime
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from in_process import serving
from postgres import postgres
from sqlalchemy import func, insert, inspect, select
from test_mission_loop import ROOMS, TARGETS, WAIT, drive, fleet
from test_plans import request

from service.app import create_app
from service.settings import Settings, sqlite_url
from service.store.engine import DatabaseUrlError, connect
from service.store.schema import prepare
from service.store.tables import METADATA, MISSIONS

MISSION = {
    "id": "m",
    "name": "survey",
    "fleet": "f",
    "domain": "marsupial",
    "is_over": False,
    "created_at": datetime(2026, 1, 1, tzinfo=UTC),
}


def test_migrations_make_the_tables_that_the_code_works_with(tmp_path: Path) -> None:
    engine = connect(sqlite_url(tmp_path / "x.sqlite"))
    prepare(engine)
    prepare(engine)  # again: nothing to do
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), METADATA) == []
    assert "alembic_version" in inspect(engine).get_table_names()
    engine.dispose()


def test_sqlite_commits_are_on_disk_when_they_return(tmp_path: Path) -> None:
    engine = connect(sqlite_url(tmp_path / "x.sqlite"))
    with engine.connect() as connection:
        assert connection.exec_driver_sql("PRAGMA journal_mode").scalar() == "wal"
        assert connection.exec_driver_sql("PRAGMA synchronous").scalar() == 2
    engine.dispose()


@pytest.mark.parametrize("name", ["", "x.sqlite"])
def test_a_reader_does_not_undo_what_another_thread_is_writing(name: str, tmp_path: Path) -> None:
    engine = connect(sqlite_url(tmp_path / name) if name else "sqlite://")
    prepare(engine)

    def count() -> int | None:
        with engine.connect() as connection:
            return connection.scalar(select(func.count()).select_from(MISSIONS))

    with ThreadPoolExecutor(1) as reader:
        with engine.begin() as connection:
            connection.execute(insert(MISSIONS).values(MISSION))
            seen = reader.submit(count)
            wait([seen], 0.2)
        assert seen.result(30.0) in (0, 1)
    assert count() == 1
    engine.dispose()


KILL_CONNECTIONS = (
    "SELECT pg_terminate_backend(pid) FROM pg_stat_activity "
    "WHERE backend_type = 'client backend' AND pid <> pg_backend_pid()"
)


@pytest.mark.parametrize("url", ["nonsense", "mysql://x/y", "carrier-pigeon://coop"])
def test_a_url_that_is_none_gets_a_sentence(url: str) -> None:
    with pytest.raises(DatabaseUrlError, match="sqlite:///FILE"):
        connect(url)


def test_missions_and_plans_on_postgresql() -> None:
    pytest.importorskip("psycopg", reason="psycopg is not installed (marsupial[postgres])")
    with postgres() as server:
        settings = Settings(database_url=server.url, planning_processes=1)
        team = fleet()
        with serving(create_app(settings)) as client:
            engine = connect(server.url)
            with engine.connect() as connection:
                assert compare_metadata(MigrationContext.configure(connection), METADATA) == []
            engine.dispose()
            url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
            for step in range(10):
                report = team.report()
                if step == 3:
                    # The administrator, or a firewall, ends every connection of the service.
                    engine = connect(server.url)
                    with engine.connect() as connection:
                        connection.exec_driver_sql(KILL_CONNECTIONS)
                    engine.dispose()
                if step == 5:
                    server.stop()
                    refused = client.post(f"{url}/reports", json=report)
                    assert refused.status_code == 503
                    assert client.get("/readyz").status_code == 503
                    assert client.get("/healthz").status_code == 200
                    server.start()
                answer = client.post(f"{url}/reports", json=report, headers=WAIT)
                assert answer.status_code == 200, answer.text
                team.obey(answer.json())
                team.step()
        with serving(create_app(settings)) as client:
            assert drive(client, url, team) == "completed"
            planned = client.post("/v1/plans", json=request(4), headers={"Prefer": "wait=30"})
            assert planned.json()["status"] == "finished"
