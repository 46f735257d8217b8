"""Domains and maps: uploaded, versioned by content, used by missions that keep their versions."""

import base64
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from in_process import InProcessClient, serving
from PIL import Image
from scripted_fleet import map_json, walls
from test_access import KEYS, by
from test_mission_loop import ROOMS, TARGETS, WAIT, drive, fleet
from travelling import DOMAIN, problem

from domains import catalogue
from service.access import ApiKey, digest
from service.app import create_app
from service.settings import Settings, sqlite_url

DISASTER = catalogue.load("disaster").domain_path.read_text()
TIDY = DISASTER.replace("(:durative-action clear", "(:durative-action tidy")
UNEXPLORED = DISASTER.replace("(explored ?t - mission_target)", "").replace(
    "(explored ?g)", "(at ?r ?g)"
)
YAML = "image: ../../etc/passwd\nresolution: 0.5\norigin: [1.0, 2.0, 0.0]\n"


@pytest.fixture
def client() -> Iterator[InProcessClient]:
    settings = Settings(database_url="sqlite://", planning_processes=1, max_map_cells=100_000)
    with serving(create_app(settings)) as started:
        yield started


def put_domain(client: InProcessClient, name: str, text: str, **headers: str) -> Any:
    return client.request("PUT", f"/v1/domains/{name}", json={"text": text}, headers=headers)


def pgm() -> bytes:
    image = io.BytesIO()
    Image.fromarray(np.array([[0, 205, 254], [254, 254, 254]], np.uint8)).save(image, "PPM")
    return image.getvalue()


def test_the_same_content_is_the_same_version(client: InProcessClient) -> None:
    first = put_domain(client, "errands", DOMAIN)
    assert first.status_code == 201, first.text
    again = put_domain(client, "errands", DOMAIN)
    assert again.status_code == 200
    assert again.headers["etag"] == first.headers["etag"]
    other = put_domain(client, "errands", DOMAIN + "\n; changed\n")
    assert other.status_code == 201
    assert other.json()["version"] != first.json()["version"]
    listed = client.get("/v1/domains/errands/versions").json()
    assert [one["version"] for one in listed] == [other.json()["version"], first.json()["version"]]
    # Back to the first: no third version, and it is current again.
    assert put_domain(client, "errands", DOMAIN).status_code == 200
    assert client.get("/v1/domains/errands").json()["version"] == first.json()["version"]
    kept = client.get(other.headers["location"])
    assert kept.json()["text"].endswith("; changed\n")
    assert "immutable" in kept.headers["cache-control"]


def test_a_change_counts_only_if_nobody_was_faster(client: InProcessClient) -> None:
    tag = put_domain(client, "errands", DOMAIN).headers["etag"]
    assert client.get("/v1/domains/errands", headers={"If-None-Match": tag}).status_code == 304
    mine = put_domain(client, "errands", DOMAIN + ";1\n", **{"If-Match": tag})
    assert mine.status_code == 201
    theirs = put_domain(client, "errands", DOMAIN + ";2\n", **{"If-Match": tag})
    assert theirs.status_code == 412
    assert theirs.headers["etag"] == mine.headers["etag"]
    assert client.get("/v1/domains/errands").json()["text"].endswith(";1\n")
    taken = put_domain(client, "errands", DOMAIN, **{"If-None-Match": "*"})
    assert taken.status_code == 412
    missing = put_domain(client, "nothing", DOMAIN, **{"If-Match": "*"})
    assert missing.status_code == 412
    nonsense = put_domain(client, "errands", DOMAIN, **{"If-Match": "yesterday's"})
    assert nonsense.status_code == 412


def test_faults_of_a_domain_are_told_with_their_places(client: InProcessClient) -> None:
    faulty = DOMAIN.replace("(at end (done ?b))", "(at end (don ?b))")
    answer = put_domain(client, "errands", faulty)
    assert answer.status_code == 422
    (finding,) = [d for d in answer.json()["diagnostics"] if d["severity"] == "error"]
    line = faulty.splitlines()[finding["line"] - 1]
    assert line[finding["column"] - 1 :].startswith("don")
    assert client.get("/v1/domains/errands").status_code == 404
    unused = DOMAIN.replace("(:predicates", "(:predicates (unused ?r - robot)")
    warned = put_domain(client, "errands", unused)
    assert warned.status_code == 201
    assert {d["severity"] for d in warned.json()["diagnostics"]} <= {"warning", "information"}
    assert warned.json()["diagnostics"]


@pytest.mark.parametrize(
    ("text", "formulation", "where"),
    [
        (DOMAIN, "unheard-of", "/formulation"),
        (DOMAIN, "disaster", "/formulation"),
        (TIDY, "disaster", "/formulation"),
        (UNEXPLORED, "disaster", "/formulation"),
        ("/etc/passwd", None, "/text"),
        ("", None, "/text"),
    ],
)
def test_a_domain_that_is_of_no_use_is_refused(
    client: InProcessClient, text: str, formulation: str | None, where: str
) -> None:
    body = {"text": text, "formulation": formulation}
    answer = client.request("PUT", "/v1/domains/mine", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["location"] == where
    assert "root:" not in answer.text


def test_names_are_safe(client: InProcessClient) -> None:
    for name in ("..", "%2e%2e", "..%2f..%2fetc", "A", "a b", "x" * 65, "-a", "caf%C3%A9"):
        answer = client.request("PUT", f"/v1/domains/{name}", json={"text": DOMAIN})
        assert answer.status_code in (404, 405, 422), name


def test_planning_requests_use_a_kept_domain(client: InProcessClient) -> None:
    version = put_domain(client, "errands", DOMAIN).json()["version"]
    for reference in ("errands", f"errands@{version[:8]}", f"errands@{version}"):
        body = {"domain": reference, "problem": problem(3), "time_limit_s": 1.0}
        answer = client.post("/v1/plans", json=body, headers=WAIT).json()
        assert answer["status"] == "finished", reference
    lost = client.post("/v1/plans", json={"domain": "errands@00000000", "problem": problem(3)})
    assert lost.status_code == 422
    assert version in lost.json()["errors"][0]["message"]


def test_a_mission_keeps_its_versions(tmp_path: Path) -> None:
    settings = Settings(database_url=sqlite_url(tmp_path / "x.sqlite"))
    team = fleet()
    faster = DISASTER.replace("[clearCost ?c ?b]", "5")
    assert faster != DISASTER
    body = {
        **team.mission(ROOMS, TARGETS, strategy="planner"),
        "domain": "disaster",
        "map": "rooms",
    }
    with serving(create_app(settings)) as client:
        unknown = client.post("/v1/missions", json=body)
        assert unknown.json()["errors"][0]["location"] == "/map"
        old_map = client.request("PUT", "/v1/maps/rooms", json=map_json(ROOMS)).json()["version"]
        old_domain = client.get("/v1/domains/disaster").json()["version"]
        url = client.post("/v1/missions", json=body).headers["location"]
        used = {(u["kind"], u["name"], u["version"]) for u in client.get(url).json()["resources"]}
        assert used == {("domain", "disaster", old_domain), ("map", "rooms", old_map)}
        cells = client.get(f"{url}/map").json()["cells"]
        walled = [[100] * len(row) for row in ROOMS]
        new_map = client.request("PUT", "/v1/maps/rooms", json=map_json(walled)).json()["version"]
        upload = {"text": faster, "formulation": "disaster"}
        new_domain = client.request("PUT", "/v1/domains/disaster", json=upload).json()["version"]
        assert new_map != old_map
        assert new_domain != old_domain
        second = client.post("/v1/missions", json={**body, "map": f"rooms@{old_map[:12]}"})
        assert second.status_code == 201, second.text
        uses = client.get("/v1/domains/disaster/missions").json()
        assert {use["version"] for use in uses} == {old_domain, new_domain}
        assert client.request("DELETE", "/v1/maps/rooms").status_code == 409
    with serving(create_app(settings)) as client:
        # The operator's domain stays current after a restart; the mission has its own.
        assert client.get("/v1/domains/disaster").json()["version"] == new_domain
        assert client.get(f"{url}/map").json()["cells"] == cells
        assert drive(client, url, team) == "completed"
        durations = {
            step["duration_s"]
            for event in client.app.state.store.events(url.rsplit("/", 1)[1])
            if event.kind == "orders-issued"
            for step in [s.model_dump() for s in event.steps]
            if step["action"] == "clear"
        }
        assert 5.0 not in durations
        assert 10.0 in durations


def test_missions_plan_with_the_domain_that_they_name(client: InProcessClient) -> None:
    team = fleet()
    upload = {
        "text": DISASTER.replace("[clearCost ?c ?b]", "7"),
        "formulation": "disaster",
    }
    assert client.request("PUT", "/v1/domains/quick", json=upload).status_code == 201
    body = {**team.mission(ROOMS, TARGETS, strategy="planner"), "domain": "quick"}
    url = client.post("/v1/missions", json=body).headers["location"]
    assert client.get(url).json()["domain"] == "quick"
    assert drive(client, url, team) == "completed"
    durations = {
        step.duration_s
        for event in client.app.state.store.events(url.rsplit("/", 1)[1])
        if event.kind == "orders-issued"
        for step in event.steps
        if step.action == "clear"
    }
    assert durations == {7.0}


def test_a_text_names_its_formulation_in_the_address(client: InProcessClient) -> None:
    plain = {"Content-Type": "text/plain"}
    path = "/v1/domains/careful?formulation="
    answer = client.request("PUT", path + "disaster", content=DISASTER, headers=plain)
    assert answer.json()["formulation"] == "disaster"
    assert client.request("PUT", path + "x", content=DISASTER, headers=plain).status_code == 422
    cut = client.request("PUT", "/v1/domains/careful", content=b"\xff(", headers=plain)
    assert cut.json()["errors"][0]["location"] == "/text"


def test_a_domain_without_formulation_is_for_planning_requests(client: InProcessClient) -> None:
    put_domain(client, "errands", DOMAIN)
    body = {**fleet().mission(ROOMS, TARGETS), "domain": "errands"}
    refused = client.post("/v1/missions", json=body)
    assert refused.status_code == 422
    assert "without a formulation" in refused.json()["errors"][0]["message"]


@pytest.mark.parametrize("way", ["multipart", "json"])
def test_a_map_server_pair(client: InProcessClient, way: str) -> None:
    if way == "multipart":
        files = {"yaml": ("m.yaml", YAML.encode()), "image": ("m.pgm", pgm())}
        answer = client.request("PUT", "/v1/maps/hall", files=files)
    else:
        pair = {"yaml": YAML, "image": base64.b64encode(pgm()).decode()}
        answer = client.request("PUT", "/v1/maps/hall", json=pair)
    assert answer.status_code == 201, answer.text
    stored = answer.json()
    assert (stored["free_cells"], stored["occupied_cells"], stored["unknown_cells"]) == (4, 1, 1)
    assert stored["map"]["origin_m"] == [1.0, 2.0]
    # The image's first row is the top: the last one of the cells.
    same = {**map_json([[0, 0, 0], [100, -1, 0]], 0.5), "origin_m": [1.0, 2.0]}
    assert client.request("PUT", "/v1/maps/hall", json=same).status_code == 200


@pytest.mark.parametrize(
    ("files", "where"),
    [
        ({"yaml": b"[", "image": b"P5"}, "/yaml"),
        ({"yaml": b"resolution: 1\norigin: [0,0,0]", "image": b"P5"}, "/yaml"),
        ({"yaml": YAML.encode(), "image": b"not an image"}, "/image"),
        ({"yaml": YAML.encode(), "image": b"P5 100000 100000 255\n"}, "/image"),
        ({"yaml": YAML.encode(), "image": b"P5 3 2 255\nab"}, "/image"),
        ({"yaml": YAML.replace("0.5", "-1").encode(), "image": None}, "/image"),
        ({"yaml": YAML.replace("0.5", "1e9").encode(), "image": None}, "/yaml"),
        ({"yaml": b"\xff", "image": None}, "/yaml"),
        ({"yaml": YAML.encode()}, ""),
        ({"image": None}, ""),
    ],
)
def test_a_pair_that_is_none_is_refused_with_the_part_at_fault(
    client: InProcessClient, files: dict[str, bytes | None], where: str
) -> None:
    sent = {name: (name, pgm() if content is None else content) for name, content in files.items()}
    answer = client.request("PUT", "/v1/maps/hall", files=sent)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["location"] == where
    assert "root:" not in answer.text


def test_bodies_that_are_no_maps(client: InProcessClient) -> None:
    large = {**map_json([[0]]), "width": 1000, "height": 1000}
    short = {**map_json([[0]]), "width": 2}
    for body, where in ((large, "/width"), (short, "/cells"), ({}, "/resolution_m")):
        answer = client.request("PUT", "/v1/maps/hall", json=body)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["location"] == where
    form = {"Content-Type": "multipart/form-data"}
    assert client.request("PUT", "/v1/maps/hall", content=b"x", headers=form).status_code == 422
    assert client.request("PUT", "/v1/maps/hall", content=b"[" * 99999).status_code == 400
    odd = client.request("PUT", "/v1/maps/full", json=map_json(walls(["###"])))
    assert "no cell is free" in odd.json()["diagnostics"][0]


def test_what_is_deleted_is_gone_and_built_in_domains_stay(client: InProcessClient) -> None:
    tag = put_domain(client, "errands", DOMAIN).headers["etag"]
    stale = client.request("DELETE", "/v1/domains/errands", headers={"If-Match": '"00"'})
    assert stale.status_code == 412
    gone = client.request("DELETE", "/v1/domains/errands", headers={"If-Match": tag})
    assert gone.status_code == 204
    assert client.get("/v1/domains/errands").status_code == 404
    assert client.request("DELETE", "/v1/domains/disaster").status_code == 409
    assert {one["name"] for one in client.get("/v1/domains").json()} == {"disaster", "marsupial"}


def test_fleets_see_and_change_their_own() -> None:
    keys = [
        ApiKey(name=name, sha256=digest(KEYS[name]), scopes=scopes, fleets=[reached])
        for name, scopes, reached in (
            ("viewer", ["read", "operate"], "south"),
            ("north", ["read", "operate", "edit"], "north"),
            ("chief", ["read", "operate", "edit"], "*"),
        )
    ]
    grid = map_json(ROOMS)
    with serving(create_app(Settings(database_url="sqlite://", api_keys=keys))) as client:

        def put(name: str, who: str, query: str = "") -> int:
            path = f"/v1/maps/{name}{query}"
            return client.request("PUT", path, json=grid, headers=by(who)).status_code

        assert put("shared", "viewer") == 403
        assert put("shared", "chief") == 201
        assert put("shared", "north") == 403
        assert put("own", "north") == 201
        assert put("theirs", "north", "?fleet=south") == 403
        assert client.get("/v1/maps/own", headers=by("viewer")).status_code == 404
        assert client.get("/v1/maps/shared", headers=by("viewer")).status_code == 200
        names = {one["name"] for one in client.get("/v1/maps", headers=by("viewer")).json()}
        assert names == {"shared"}
        body = {**fleet().mission(ROOMS, TARGETS, fleet="north"), "map": "own"}
        assert client.post("/v1/missions", json=body, headers=by("north")).status_code == 201
        stolen = client.post("/v1/missions", json={**body, "fleet": "south"}, headers=by("chief"))
        assert stolen.json()["errors"][0]["location"] == "/map"
