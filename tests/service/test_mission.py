"""The mission aggregate: duplicates, late reports, restarts."""

from typing import Any

from in_process import serving
from scripted_fleet import walls
from test_mission_loop import ROOMS, TARGETS, WAIT, drive, fleet

from service.app import create_app
from service.coordination.events import from_json, to_json
from service.coordination.history import rebuilt
from service.settings import Settings, sqlite_url
from service.store.engine import connect
from service.store.event_store import EventStore


def test_a_report_sent_again_changes_nothing() -> None:
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        body = team.report()
        first = client.post(f"{url}/reports", json=body, headers=WAIT).json()
        again = client.post(f"{url}/reports", json=body, headers=WAIT).json()
        assert again == first
        assert first["mission"]["sequence"] == 0


def test_an_overtaken_report_contributes_its_facts_but_not_its_poses() -> None:
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        team.obey(client.post(f"{url}/reports", json=team.report(), headers=WAIT).json())
        team.step()
        overtaken = team.report()
        assert overtaken["blockades"]
        team.step()
        later = team.report()
        client.post(f"{url}/reports", json=later, headers=WAIT)
        assert client.get(url).json()["blockades"] == []
        client.post(f"{url}/reports", json=overtaken, headers=WAIT)
        mission = client.get(url).json()
        assert [blockade["id"] for blockade in mission["blockades"]] == ["blockade_1"]
        assert mission["robots"][0]["pose"] == later["robots"][0]["pose"]
        assert mission["sequence"] == 2
        # Known by now: not even its facts count twice.
        before = client.get(url).json()
        client.post(f"{url}/reports", json=overtaken, headers=WAIT)
        assert client.get(url).json() == before


def test_the_log_adds_up_to_the_mission(tmp_path: Any) -> None:
    url = sqlite_url(tmp_path / "log.sqlite")
    team = fleet()
    with serving(create_app(Settings(database_url=url))) as client:
        where = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        drive(client, where, team)
        live = client.get(where).json()
    store = EventStore(connect(url))
    events = list(store.events(where.rsplit("/", 1)[1]))
    store.close()
    mission = rebuilt(from_json(to_json(event)) for event in events)
    assert mission.status == "completed"
    assert mission.replans == live["replans"]
    assert [d.model_dump() for d in mission.decisions] == live["decisions"]
    # Over: found in the log, and no longer open.
    with serving(create_app(Settings(database_url=url))) as client:
        assert client.get(where).json() == live


def test_a_mission_goes_on_after_a_restart(tmp_path: Any) -> None:
    url = sqlite_url(tmp_path / "log.sqlite")
    team = fleet()
    with serving(create_app(Settings(database_url=url))) as client:
        where = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        for _ in range(10):
            team.obey(client.post(f"{where}/reports", json=team.report(), headers=WAIT).json())
            team.step()
    with serving(create_app(Settings(database_url=url))) as client:
        assert drive(client, where, team) == "completed"


def test_a_mission_without_a_way_is_delayed_and_says_why() -> None:
    team = fleet()
    sealed = walls(["#########", "#...#...#", "#...#...#", "#########"])
    team.robots[0].position = (1.5, 1.5)
    team.robots[1].position = (2.5, 1.5)
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        body = team.mission(sealed, [(6.5, 1.5)])
        url = client.post("/v1/missions", json=body).headers["location"]
        answer = client.post(f"{url}/reports", json=team.report(), headers=WAIT).json()
        assert answer["mission"]["status"] == "delayed"
        assert "no robot can reach" in client.get(url).json()["status_reason"]
