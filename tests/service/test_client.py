"""The client against a real server: every call, over a socket, across a restart."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import uvicorn
from scripted_fleet import map_json
from test_mission_loop import ROOMS, TARGETS, fleet
from travelling import DOMAIN, problem

from service.app import create_app
from service.client import Client, Patience, ServiceError
from service.coordination.events import Event
from service.messages.instruction import Forbid, TakeOver
from service.messages.map_grid import MapMessage
from service.messages.mission import MissionRequest, RobotMessage, TargetMessage
from service.messages.planning import PlanSubmission
from service.messages.report import Report
from service.messages.resource import DomainUpload
from service.settings import Settings, sqlite_url


@contextmanager
def listening(settings: Settings, port: int = 0) -> Iterator[int]:
    """The service on a port; yields the port."""
    server = uvicorn.Server(
        uvicorn.Config(
            create_app(settings), port=port, log_config=None, timeout_graceful_shutdown=1
        )
    )
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            time.sleep(0.01)
        yield server.servers[0].sockets[0].getsockname()[1]
    finally:
        server.should_exit = True
        thread.join()


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    settings = Settings(database_url="sqlite://", planning_processes=1, max_wait_s=20)
    with listening(settings) as port:
        found = Client.at(f"http://127.0.0.1:{port}", patience=Patience(give_up_after_s=20.0))
        yield found
        found.close()


def read(body: object) -> MissionRequest:
    import json

    return MissionRequest.model_validate_json(json.dumps(body))


def request() -> MissionRequest:
    return read(fleet().mission(ROOMS, TARGETS, strategy="hungarian"))


def drive(client: Client, mission_id: str, on_step: Callable[[int], None] = lambda _: None) -> None:
    """A scripted fleet drives the mission to its end."""
    import json

    team = fleet()
    for step in range(400):
        on_step(step)
        report = Report.model_validate_json(json.dumps(team.report()))
        answer = client.report(mission_id, report, wait_s=10)
        if answer.mission.status in ("completed", "failed"):
            return
        team.obey(json.loads(answer.model_dump_json()))
        team.step()
    raise AssertionError("the mission did not end")


def test_a_mission_from_creation_to_its_last_event(client: Client) -> None:
    created = client.create_mission(request())
    assert created.status == "queued"
    drive(client, created.id)
    mission = client.mission(created.id)
    assert mission.status == "completed"
    assert mission.targets_left == 0
    assert client.plan(created.id).revision == mission.revision
    assert client.known_map(created.id).width == 20
    events = list(client.events(created.id))
    assert [number for number, _ in events] == list(range(len(events)))
    assert events[-1][1].kind == "mission-closed"
    assert next(iter(client.events(created.id, after=5)))[0] == 6
    assert created.id in {one.id for one in client.missions()}


def test_the_same_key_creates_one_mission(client: Client) -> None:
    first = client.create_mission(request(), idempotency_key="monday")
    assert client.create_mission(request(), idempotency_key="monday").id == first.id
    other = request().model_copy(update={"name": "another"})
    with pytest.raises(ServiceError, match="Idempotency-Key") as caught:
        client.create_mission(other, idempotency_key="monday")
    assert caught.value.status == 422
    assert client.cancel(first.id).status == "canceled"


def test_people(client: Client) -> None:
    mission = client.create_mission(request()).id
    given = client.instruct(mission, Forbid(kind="forbid", robot="explorer_1", location="target_1"))
    assert given.remark == ""
    assert [one.id for one in client.mission(mission).instructions] == [given.id]
    assert client.withdraw(mission, given.id).instructions == []
    taken = client.instruct(mission, TakeOver(kind="take-over", robot="explorer_1"))
    assert client.mission(mission).robots[0].taken_over
    client.withdraw(mission, taken.id)
    target = TargetMessage(id="late", position_m=(2.5, 1.5))
    assert len(client.add_target(mission, target).targets) == 4
    assert client.remove_target(mission, "late").targets[-1].removed
    robot = RobotMessage(id="third", type="explorer", pose=(2.5, 1.5, 0.0))
    assert len(client.add_robot(mission, robot).robots) == 3
    assert client.remove_robot(mission, "third").robots[-1].left
    with pytest.raises(ServiceError, match="explorer_9"):
        client.instruct(mission, TakeOver(kind="take-over", robot="explorer_9"))
    client.cancel(mission)


def test_planning_requests(client: Client) -> None:
    body = PlanSubmission(domain_text=DOMAIN, problem=problem(4), time_limit_s=5.0)
    done = client.submit(body, wait_s=15)
    assert done.status == "finished"
    assert done.plan is not None
    assert client.plan_result(done.id) == done
    kinds = [told["kind"] for told in client.plan_events(done.id)]
    assert kinds[-1] == "finished"
    assert set(kinds[:-1]) == {"plan"}
    long = PlanSubmission(domain_text=DOMAIN, problem=problem(14), time_limit_s=60.0)
    running = client.submit(long)
    assert client.cancel_plan(running.id).status == "canceled"


def test_domains_and_maps(client: Client) -> None:
    import json

    first = client.put_domain("errands", DomainUpload(text=DOMAIN))
    client.put_domain("errands", DomainUpload(text=DOMAIN + "\n"), if_match=first.version)
    with pytest.raises(ServiceError, match="412"):
        client.put_domain("errands", DomainUpload(text=DOMAIN), if_match=first.version)
    assert client.domain("errands", first.version[:8]).text == DOMAIN
    grid = MapMessage.model_validate_json(json.dumps(map_json(ROOMS)))
    kept = client.put_map("rooms", grid)
    assert client.map("rooms").version == kept.version
    assert kept.free_cells > 0
    mission = client.create_mission(request().model_copy(update={"map": "rooms"}))
    uses = client.uses("maps", "rooms")
    assert [(use.mission, use.version) for use in uses] == [(mission.id, kept.version)]
    assert {one.name for one in client.domains()} == {"disaster", "errands", "marsupial"}
    assert [one.name for one in client.maps()] == ["rooms"]
    client.cancel(mission.id)


def test_a_mission_and_its_events_survive_a_restart(tmp_path: Path) -> None:
    settings = Settings(database_url=sqlite_url(tmp_path / "x.sqlite"))
    heard: list[tuple[int, Event]] = []
    with listening(settings) as port:
        client = Client.at(f"http://127.0.0.1:{port}", patience=Patience(give_up_after_s=20.0))
        mission = client.create_mission(request()).id
        listener = threading.Thread(target=lambda: heard.extend(client.events(mission)))
        listener.start()
        client.report(mission, Report(sequence=0, time_s=0.0), wait_s=5)
    with listening(settings, port):
        assert client.mission(mission).sequence == 0
        client.cancel(mission)
        listener.join(20.0)
    assert not listener.is_alive()
    assert [number for number, _ in heard] == list(range(len(heard)))
    assert heard[-1][1].kind == "mission-closed"
    client.close()
