from pathlib import Path

import pytest

from scenarios.cli import main
from simulator.occupancy_grid import read_map_server
from simulator.slam.carmen import write_carmen
from simulator.slam.g2o import read_g2o, write_g2o
from tests.simulator.slam.graphs import square_graph
from tests.simulator.slam.rooms import office_drive


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["slam", *words])
    return int(ended.value.code or 0)


def test_a_pose_graph_is_optimised(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    graph, _ = square_graph(seed=1)
    write_g2o(graph, tmp_path / "square.g2o")
    out = tmp_path / "new" / "best.g2o"
    assert run("optimise", str(tmp_path / "square.g2o"), "--out", str(out)) == 0
    assert "48 poses" in capsys.readouterr().out
    assert len(read_g2o(out).poses) == 48


def test_a_log_becomes_a_map(tmp_path: Path) -> None:
    write_carmen(office_drive(0, 1).scans[:120], tmp_path / "robot.log")
    assert run("map", str(tmp_path / "robot.log"), "--out", str(tmp_path / "out")) == 0
    grid = read_map_server(tmp_path / "out" / "map.yaml")
    assert (grid.cells == 100).sum() > 100
    assert (tmp_path / "out" / "robot-corrected.log.gz").is_file()


def test_bad_input_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bad.g2o").write_text("EDGE_SE2 0 1 1\n")
    assert run("optimise", str(tmp_path / "bad.g2o")) != 0
    assert "bad.g2o:1" in capsys.readouterr().err
    assert run("map", str(tmp_path / "nowhere.log")) != 0
    assert "check the path" in capsys.readouterr().err
    assert run("experiments", "--only", "nothing") != 0
    assert "choose of corridors" in capsys.readouterr().err
