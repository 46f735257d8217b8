"""`marsupial map` from scans to pictures and to the planner's map."""

from pathlib import Path

import numpy as np
import octomap
import pytest
from PIL import Image

from scenarios.cli import main
from simulator.mapping.scene import DepthSensor, tabletop_scene
from simulator.occupancy_grid import read_map_server


def marsupial(*words: object) -> int:
    with pytest.raises(SystemExit) as end:
        main([str(word) for word in words])
    return int(end.value.code or 0)


def width(picture: Path) -> int:
    with Image.open(picture) as image:
        return image.width


@pytest.fixture
def scan_log(tmp_path: Path) -> Path:
    """Two scans of a room with a table, from either side, as an OctoMap text log."""
    lines = []
    for x, yaw in ((-2.0, 0.0), (2.0, np.pi)):
        points = DepthSensor(columns=80, rows=60).measure(tabletop_scene(), (x, 0, 1.3), yaw, 0.4)
        local = (points - [x, 0, 1.3]) * [np.cos(yaw), np.cos(yaw), 1]
        lines += [f"NODE {x} 0 1.3 0 0 {yaw}", *(f"{a} {b} {c}" for a, b, c in local)]
    (tmp_path / "room.log").write_text("\n".join(lines))
    return tmp_path / "room.log"


def test_scans_become_a_map_a_picture_and_a_plane_to_drive_in(
    scan_log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room = tmp_path / "room.ot"
    assert marsupial("map", "insert", scan_log, "--out", room, "--resolution", 0.05) == 0
    beams = sum("NODE" not in line for line in scan_log.read_text().splitlines())
    assert f"{beams:,} beams" in capsys.readouterr().out
    assert octomap.OcTree.read(bytes(room)).getResolution() == 0.05
    assert marsupial("map", "insert", scan_log, "--into", room, "--out", tmp_path / "b.bt") == 0
    assert marsupial("map", "info", room) == 0
    told = capsys.readouterr().out
    assert "known of 0.05 m" in told
    assert "z 0.00 to 0.95 m" in told
    picture = tmp_path / "pictures" / "room.png"
    assert marsupial("map", "render", room, "--out", picture, "--below", 1.2) == 0
    assert width(picture) == 1200
    assert marsupial("map", "render", room, "--out", picture, "--slice", 0.1, 1.0) == 0
    assert width(picture) < 200
    for height, expected in ((0.5, 0), (1.5, 100)):
        plane = tmp_path / "plane.yaml"
        assert marsupial("map", "convert", room, plane, "--robot-height", height) == 0
        grid = read_map_server(plane)
        column = int((0.5 - grid.origin_m[0]) / 0.05)
        row = int((0.2 - grid.origin_m[1]) / 0.05)
        if height > 1:
            assert grid.cells[row, column] == expected
        else:
            assert grid.cells[row, column] != 100


def test_what_cannot_be_done_is_said_in_a_sentence(
    scan_log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "room.ot"
    assert marsupial("map", "insert", scan_log, "--out", tmp_path / "room.jpg") == 31
    assert "maps are written as .bt or .ot" in capsys.readouterr().err
    words = ("--resolution", 0.005, "--memory-limit", 1)
    assert marsupial("map", "insert", scan_log, "--out", out, *words) == 31
    assert "limit of 1000000 bytes" in capsys.readouterr().err
    assert not out.exists()
    (tmp_path / "no.bt").write_text("nothing\n")
    assert marsupial("map", "info", tmp_path / "no.bt") == 31
    assert "not an OctoMap file" in capsys.readouterr().err
    assert marsupial("map", "insert", scan_log, "--out", out) == 0
    assert marsupial("map", "render", out, "--above", 90) == 31
    assert "nothing lies between" in capsys.readouterr().err
