"""What goes wrong around a service: full disks, lost connections, jumping clocks, lying clients."""

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


class FullDisk:
    """Makes every write of an engine fail, as SQLite does on a full disk."""

    def __init__(self, client: InProcessClient) -> None:
        self.full = False
        event.listen(client.app.state.store._engine, "before_cursor_execute", self._refuse)

    def _refuse(self, *arguments: Any) -> None:
        statement = arguments[2]
        if self.full and statement.startswith("INSERT"):
            raise OperationalError(statement, {}, Exception("database or disk is full"))


def test_a_full_disk_refuses_reports_until_there_is_room_again(tmp_path: Path) -> None:
    team = fleet()
    with serving(create_app(Settings(database_url=sqlite_url(tmp_path / "x.sqlite")))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        disk = FullDisk(client)
        for step in range(400):
            report = team.report()
            if step in (3, 20):
                disk.full = True
                before = client.get(url).json()
                refused = client.post(f"{url}/reports", json=report)
                assert refused.status_code == 503
                assert refused.headers["retry-after"]
                assert "disk is full" in refused.json()["detail"]
                assert client.get(url).json() == before
                created = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS))
                assert created.status_code == 503
                disk.full = False
            answer = client.post(f"{url}/reports", json=report, headers=WAIT).json()
            if answer["mission"]["status"] == "completed":
                break
            team.obey(answer)
            team.step()
        assert client.get(url).json()["status"] == "completed"


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


def test_a_clock_that_jumps_back_does_not_turn_time_back() -> None:
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        for step in range(400):
            if step == 10:
                team.time_s -= 8.0
            answer = client.post(f"{url}/reports", json=team.report(), headers=WAIT).json()
            if answer["mission"]["status"] == "completed":
                break
            team.obey(answer)
            team.step()
        mission = client.get(url).json()
    assert mission["status"] == "completed"
    times = [decision["time_s"] for decision in mission["decisions"] if decision["kind"] != "x"]
    assert times == sorted(times)


@pytest.mark.slow
@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.data())
def test_duplicates_and_reordering_execute_nothing_twice(data: st.DataObject) -> None:
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
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
