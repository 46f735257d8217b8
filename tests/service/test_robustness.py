"""What goes wrong around a service: full disks, lost connections, jumping clocks, lying clients."""

from datetime import UTC, datetime, tzinfo
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from in_process import InProcessClient, serving
from sqlalchemy import event
from sqlalchemy.exc import OperationalError
from test_mission_loop import ROOMS, TARGETS, WAIT, drive, fleet

from service.app import create_app
from service.settings import Settings, sqlite_url

LATEST_S = 30.0
"""by which a report comes late at the most"""


class FullDisk:
    """Gives an SQLite database no further page: SQLite itself then finds the disk full."""

    ROOM = 2**30

    def __init__(self, client: InProcessClient) -> None:
        self.full = False
        event.listen(client.app.state.store._engine, "checkout", self._limit)

    def _limit(self, connection: Any, *_: Any) -> None:
        cursor = connection.cursor()
        (pages,) = cursor.execute("PRAGMA page_count").fetchone()
        cursor.execute(f"PRAGMA max_page_count={pages if self.full else self.ROOM}")
        cursor.close()


def test_a_full_disk_refuses_reports_until_there_is_room_again(tmp_path: Path) -> None:
    team = fleet()
    with serving(create_app(Settings(database_url=sqlite_url(tmp_path / "x.sqlite")))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        disk = FullDisk(client)
        refusals = 0
        for step in range(400):
            report = team.report()
            disk.full = 3 <= step < 10 or 14 <= step < 24
            before = client.get(url).json()
            answer = client.post(f"{url}/reports", json=report, headers=WAIT)
            if answer.status_code == 503:
                refusals += 1
                assert answer.headers["retry-after"]
                assert "disk is full" in answer.json()["detail"]
                assert client.get(url).json() == before
                created = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS))
                assert created.status_code == 503
                disk.full = False
                answer = client.post(f"{url}/reports", json=report, headers=WAIT)
            assert answer.status_code == 200, answer.text
            if answer.json()["mission"]["status"] == "completed":
                break
            team.obey(answer.json())
            team.step()
        assert refusals >= 3
        assert client.get(url).json()["status"] == "completed"
        numbers = [number for number, _ in client.app.state.store.numbered(url.rsplit("/", 1)[1])]
        assert numbers == list(range(len(numbers)))


def test_an_append_whose_answer_was_lost_is_found_in_the_log(tmp_path: Path) -> None:
    """The commit happened, but the service was told that it had not."""
    team = fleet()
    with serving(create_app(Settings(database_url=sqlite_url(tmp_path / "x.sqlite")))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        store = client.app.state.store
        lost = []

        def lose(connection: Any) -> None:
            if not lost:
                lost.append(True)
                connection.connection.commit()
                raise OperationalError("COMMIT", {}, Exception("connection lost"))

        event.listen(store._engine, "commit", lose)
        report = team.report()
        assert client.post(f"{url}/reports", json=report).status_code == 503
        again = client.post(f"{url}/reports", json=report, headers=WAIT)
        assert again.status_code == 200
        assert again.json()["mission"]["sequence"] == 0
        kinds = [e.kind for e in store.events(url.rsplit("/", 1)[1])]
        assert kinds.count("report-accepted") == 1
        assert drive(client, url, team) == "completed"


@pytest.mark.parametrize("jump_s", [-8.0, 3600.0])
def test_a_fleet_whose_clock_jumps_gets_on(jump_s: float) -> None:
    """Back: time is not turned back. Forth: robots that look late get on with what they do."""
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        for step in range(400):
            if step == 10:
                team.time_s += jump_s
                for robot in team.robots:
                    if robot.busy_until_s is not None:
                        robot.busy_until_s += jump_s
            answer = client.post(f"{url}/reports", json=team.report(), headers=WAIT).json()
            if answer["mission"]["status"] == "completed":
                break
            team.obey(answer)
            team.step()
        mission = client.get(url).json()
    assert mission["status"] == "completed"
    times = [decision["time_s"] for decision in mission["decisions"]]
    assert times == sorted(times)
    deeds = [(kind, place) for _, kind, place in team.executed if kind in ("explore", "clear")]
    assert len(deeds) == len(set(deeds))


def test_a_service_whose_clock_jumps_keeps_its_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """The machine's clock is set back by a day in the middle: events keep their numbers."""
    days = [datetime(2030, 1, 2, tzinfo=UTC), datetime(2030, 1, 1, tzinfo=UTC)]

    class Jumping(datetime):
        @classmethod
        def now(cls, tz: tzinfo | None = None) -> "Jumping":
            day = days[0] if len(days) == 2 else days[-1]
            return cls.fromtimestamp(day.timestamp(), tz)

    monkeypatch.setattr("service.store.event_store.datetime", Jumping)
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        first = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).json()["id"]
        for _ in range(5):
            answer = client.post(f"/v1/missions/{first}/reports", json=team.report(), headers=WAIT)
            team.obey(answer.json())
            team.step()
        del days[0]
        assert drive(client, f"/v1/missions/{first}", team) == "completed"
        second = client.post("/v1/missions", json=fleet().mission(ROOMS, TARGETS)).json()["id"]
        assert {m["id"] for m in client.get("/v1/missions").json()} == {first, second}
        numbers = [number for number, _ in client.app.state.store.numbered(first)]
        assert numbers == list(range(len(numbers)))


@pytest.mark.slow
@settings(
    max_examples=10, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.data())
def test_duplicates_and_reordering_execute_nothing_twice(data: st.DataObject) -> None:
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://", executor="threads"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        sent: list[dict[str, Any]] = []
        delayed: list[dict[str, Any]] = []
        for _ in range(120):
            report = team.report()
            sent.append(report)
            if data.draw(st.integers(0, 4)) == 0:
                delayed.append(report)
            else:
                client.post(f"{url}/reports", json=report, headers=WAIT)
            if data.draw(st.integers(0, 3)) == 0 and delayed:
                client.post(f"{url}/reports", json=delayed.pop(), headers=WAIT)
            # After a minute the service takes a command for lost and gives it again.
            while delayed and team.time_s - delayed[0]["time_s"] > LATEST_S:
                client.post(f"{url}/reports", json=delayed.pop(0), headers=WAIT)
            answer = client.post(
                f"{url}/reports", json=data.draw(st.sampled_from(sent[-3:])), headers=WAIT
            ).json()
            if answer["mission"]["status"] == "completed":
                break
            team.obey(answer)
            team.step()
        for report in delayed:
            client.post(f"{url}/reports", json=report, headers=WAIT)
        assert client.get(url).json()["status"] == "completed"
    deeds = [(kind, place) for _, kind, place in team.executed if kind in ("explore", "clear")]
    assert len(deeds) == len(set(deeds))
