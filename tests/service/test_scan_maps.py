"""Scan messages, and 3D maps that outlive a restart; the map is a double that counts."""

import struct
from pathlib import Path

import numpy as np
import pytest
from in_process import InProcessClient, serving
from numpy.typing import NDArray
from scripted_fleet import Robot, ScriptedFleet, walls

from service.app import create_app
from service.scan_maps import HEADER, Frame, ScanError, read_scan
from service.settings import Settings

HALL = walls(["######", "#....#", "#....#", "######"])


class CountingMap:
    """A plug-in that remembers how many beams it was given."""

    def __init__(self, resolution_m: float, limit_bytes: int, contents: bytes | None) -> None:
        self.resolution_m, self.limit = resolution_m, limit_bytes
        self.beams = 0 if contents is None else int(contents.splitlines()[-1])

    def insert(
        self,
        _origin_m: tuple[float, float, float],
        points_m: NDArray[np.float32],
        _max_range_m: float | None,
    ) -> None:
        if self.beams + len(points_m) > self.limit // 10**6:
            raise MemoryError("more beams than fit")
        self.beams += len(points_m)

    def to_bytes(self, _ending: str) -> bytes:
        return f"# map\nres {self.resolution_m}\ndata\n{self.beams}".encode()

    def passage(
        self, frame: Frame, _floor_m: float, _step_m: float, height_m: float
    ) -> NDArray[np.int8]:
        cells = np.zeros((frame.height, frame.width), np.int8)
        cells[:, 3:] = 100 if height_m > 1 else 0
        return cells

    def band(self, frame: Frame, low_m: float, _high_m: float) -> NDArray[np.int8]:
        return np.full((frame.height, frame.width), round(low_m), np.int8)

    def memory_bytes(self) -> int:
        return self.beams


def message(beams: list[list[float]]) -> bytes:
    header = HEADER.pack(b"MSCN", 1, 0, 1.0, 2.0, 0.5, 0.0, len(beams))
    return header + np.array(beams, dtype="<f4").tobytes()


def begun(client: InProcessClient) -> str:
    team = ScriptedFleet([Robot("explorer_1", "explorer", (1.5, 1.5))])
    return str(
        client.post("/v1/missions", json=team.mission(HALL, [(4.5, 1.5)])).headers["location"]
    )


def test_both_encodings_give_the_end_points_in_the_map_frame() -> None:
    origin, points = read_scan(message([[1, 0, 0], [np.nan, 0, 0], [0, 0, -0.5]]))
    assert origin == (1.0, 2.0, 0.5)
    assert points.tolist() == [[2.0, 2.0, 0.5], [1.0, 2.0, 0.0]]
    header = HEADER.pack(b"MSCN", 1, 1, 1.0, 2.0, 0.5, 0.01, 1)
    _, points = read_scan(header + struct.pack("<3h", 100, -200, 50))
    assert points == pytest.approx(np.array([[2.0, 0.0, 1.0]]), abs=1e-6)


@pytest.mark.parametrize(
    ("body", "why"),
    [
        (b"short", "no scan"),
        (b"XXXX" + message([[1, 0, 0]])[4:], "begins with b'XXXX'"),
        (message([[1, 0, 0]])[:-1], "1 beams take"),
        (HEADER.pack(b"MSCN", 1, 7, 0, 0, 0, 0, 0), "encoding 7"),
        (HEADER.pack(b"MSCN", 1, 1, 0, 0, 0, 0, 0), "scale of 0.0 m"),
        (HEADER.pack(b"MSCN", 1, 0, np.nan, 0, 0, 0, 0), "not a position"),
    ],
)
def test_what_is_no_scan_is_refused_with_the_reason(body: bytes, why: str) -> None:
    with pytest.raises(ScanError, match=why):
        read_scan(body)


def test_maps_outlive_the_service_and_say_when_they_are_full(tmp_path: Path) -> None:
    settings = Settings(
        database_url=f"sqlite:///{tmp_path / 'log.sqlite'}",
        scan_maps_folder=tmp_path / "maps",
        max_scan_map_mb=5,
        planning_workers=1,
    )
    with serving(create_app(settings, scan_maps=CountingMap)) as client:
        url = begun(client)
        assert client.get(f"{url}/scan-map").status_code == 404
        scans = f"{url}/scans?robot=explorer_1"
        answer = client.post(scans, content=message([[1, 0, 0]] * 3))
        assert answer.json() == {"beams": 3, "scans": {"explorer_1": 1}, "memory_bytes": 3}
        assert client.post(scans, content=message([[1, 0, 0]] * 3)).status_code == 409
        assert client.post(scans, content=b"nonsense").status_code == 422
        wrong = client.post(f"{scans}&resolution_m=0.2", content=message([[1, 0, 0]]))
        assert "voxels of 0.1 m" in wrong.json()["detail"]
        assert client.post(f"{url}/scans?robot=nobody", content=b"").status_code == 404
    with serving(create_app(settings, scan_maps=CountingMap)) as client:
        assert client.get(f"{url}/scan-map").content.endswith(b"data\n3")
        client.delete(url)
        assert client.post(scans, content=message([[1, 0, 0]])).status_code == 409


def test_passages_put_heights_into_terrain_classes() -> None:
    with serving(create_app(Settings(database_url="sqlite://"), scan_maps=CountingMap)) as client:
        team = ScriptedFleet([Robot("explorer_1", "explorer", (1.5, 1.5))])
        mission = team.mission(HALL, [(4.5, 1.5)])
        mission["map"]["terrain_classes"] = ["default", "low"]
        url = client.post("/v1/missions", json=mission).headers["location"]
        client.post(f"{url}/scans?robot=explorer_1", content=message([[1, 0, 0]]))
        patch = client.get(f"{url}/scan-map/passages?height=default:1.8&height=low:0.5").json()
        assert (patch["row"], patch["column"], patch["width"], patch["height"]) == (0, 0, 6, 4)
        report = {**team.report(), "map_patches": [patch]}
        assert client.post(f"{url}/reports", json=report).status_code == 200
        assert client.get(f"{url}/map").json()["terrain"] is not None
        assert client.get(f"{url}/scan-map/slice?low_m=1&high_m=2").status_code == 200
        assert client.get(f"{url}/scan-map/slice?low_m=2&high_m=1").status_code == 422
        wrong = client.get(f"{url}/scan-map/passages?height=water:1")
        assert "default, low" in wrong.json()["detail"]


def test_without_a_plug_in_the_service_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.app.installed", lambda: None)
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = begun(client)
        answer = client.post(f"{url}/scans?robot=explorer_1", content=message([[1, 0, 0]]))
        assert answer.status_code == 404
