"""API keys: who is let in, to do what, with whose missions."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import typer
from in_process import InProcessClient, serving
from test_mission_loop import ROOMS, TARGETS, fleet
from travelling import DOMAIN, problem
from typer.testing import CliRunner

from service.access import ApiKey, KeyFileError, digest, new_key, read_keys
from service.app import create_app
from service.commands.new_key import new_api_key
from service.settings import Settings

KEYS = {
    name: new_key(name, scopes, fleets)[0]
    for name, scopes, fleets in (
        ("viewer", ["read"], ["*"]),
        ("north", ["read", "operate"], ["north"]),
        ("chief", ["read", "operate", "edit"], ["*"]),
    )
}


@pytest.fixture(scope="module")
def client() -> Iterator[InProcessClient]:
    keys = [
        ApiKey(name="viewer", sha256=digest(KEYS["viewer"]), scopes=["read"]),
        ApiKey(
            name="north", sha256=digest(KEYS["north"]), scopes=["read", "operate"], fleets=["north"]
        ),
        ApiKey(name="chief", sha256=digest(KEYS["chief"]), scopes=["read", "operate", "edit"]),
    ]
    with serving(create_app(Settings(database_url="sqlite://", api_keys=keys))) as started:
        yield started


def by(name: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {KEYS[name]}"}


def create(client: InProcessClient, fleet_name: str, caller: str) -> tuple[int, str]:
    body = fleet().mission(ROOMS, TARGETS, fleet=fleet_name)
    answer = client.post("/v1/missions", json=body, headers=by(caller))
    return answer.status_code, answer.headers.get("location", "")


def test_nobody_gets_in_without_a_key(client: InProcessClient) -> None:
    for headers in ({}, {"Authorization": "Bearer mk_guess"}, {"Authorization": "Basic YTpi"}):
        for path in (
            "/v1/missions",
            "/v1/plans/x",
            "/package",
            "/metrics",
            "/v1/missions/x/events",
        ):
            answer = client.get(path, headers=headers)
            assert answer.status_code == 401, path
            assert answer.headers["www-authenticate"] == "Bearer"
            assert answer.headers["content-type"] == "application/problem+json"
    assert client.get("/healthz").status_code == 200
    assert client.get("/readyz").status_code == 200


def test_a_key_does_what_its_scopes_say(client: InProcessClient) -> None:
    status, url = create(client, "north", "chief")
    assert status == 201
    assert client.get(url, headers=by("viewer")).status_code == 200
    assert client.delete(url, headers=by("viewer")).status_code == 403
    assert create(client, "north", "viewer")[0] == 403
    target = {"id": "late", "position_m": [2.5, 1.5]}
    assert client.post(f"{url}/targets", json=target, headers=by("north")).status_code == 403
    assert client.post(f"{url}/targets", json=target, headers=by("chief")).status_code == 201


def test_a_key_reaches_its_fleets_only(client: InProcessClient) -> None:
    status, south = create(client, "south", "chief")
    assert status == 201
    assert create(client, "south", "north")[0] == 403
    assert create(client, "north", "north")[0] == 201
    for path in ("", "/plan", "/map", "/events"):
        assert client.get(south + path, headers=by("north")).status_code == 404
    report = {"sequence": 0, "time_s": 0.0}
    assert client.post(f"{south}/reports", json=report, headers=by("north")).status_code == 404
    seen = {mission["id"] for mission in client.get("/v1/missions", headers=by("north")).json()}
    assert south.rsplit("/", 1)[1] not in seen


def test_planning_requests_are_their_clients_business(client: InProcessClient) -> None:
    body = {"domain_text": DOMAIN, "problem": problem(3), "time_limit_s": 0.2}
    by_north = client.post("/v1/plans", json=body, headers=by("north")).headers["location"]
    by_chief = client.post("/v1/plans", json=body, headers=by("chief")).headers["location"]
    assert client.get(by_north, headers=by("north")).status_code == 200
    assert client.get(by_north, headers=by("chief")).status_code == 200
    assert client.get(by_chief, headers=by("north")).status_code == 404
    assert client.delete(by_chief, headers=by("north")).status_code == 404
    check = by_chief.replace("/v1/plans", "/check")
    assert "Error" in client.get(check, headers=by("north")).json()


def test_a_key_is_kept_as_a_hash(tmp_path: Path) -> None:
    app = typer.Typer()
    app.command()(new_api_key)
    path = tmp_path / "keys.toml"
    arguments = ["ops", "--keys", str(path), "--scope", "read", "--fleet", "north"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    key = result.output.strip()
    assert key not in path.read_text()
    (kept,) = read_keys(path)
    assert kept.sha256 == digest(key)
    assert kept.scopes == ["read"]
    assert kept.fleets == ["north"]
    assert path.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize(
    ("text", "word"),
    [("", "no [[key]]"), ("[[key]", "line 1"), ('[[key]]\nname = "a"', "sha256")],
)
def test_a_bad_key_file_gets_a_sentence(tmp_path: Path, text: str, word: str) -> None:
    path = tmp_path / "keys.toml"
    path.write_text(text)
    with pytest.raises(KeyFileError, match=r"keys\.toml") as caught:
        read_keys(path)
    assert word in str(caught.value)
