"""Engines of unified-planning beside the process that asks them."""

import subprocess
import sys
from pathlib import Path

import pytest

from planner import peer_process, unified_planning_engine
from tests.planner.problems import MATCH_CELLAR


@pytest.fixture
def home(tmp_path: Path) -> Path:
    (tmp_path / "domain.pddl").write_text(MATCH_CELLAR.domain)
    (tmp_path / "problem.pddl").write_text(MATCH_CELLAR.problem)
    return tmp_path


def test_every_plan_of_an_anytime_engine_is_written(home: Path) -> None:
    assert unified_planning_engine  # importing it registers our own engine
    peer_process.main("marsupial", 2, home)
    files = sorted(home.glob("plan.*"))
    assert [path.name for path in files] == [f"plan.{k}" for k in range(1, len(files) + 1)]
    assert "(light_match m1) [8.0]" in files[-1].read_text()


def test_what_is_wrong_is_one_line(home: Path) -> None:
    command = [sys.executable, "-m", "planner.peer_process", "nobody", "1"]
    root = str(Path(peer_process.__file__).parents[1])
    done = subprocess.run(
        command, cwd=home, env={"PYTHONPATH": root}, capture_output=True, check=False
    )
    assert done.returncode == 1
    assert len(done.stderr.decode().strip().splitlines()) == 1
    assert "nobody" in done.stderr.decode()


def test_of_a_server_that_broke_off_it_is_said_what_its_connection_says() -> None:
    class BrokenOffError(Exception):
        def __str__(self) -> str:
            return "<RPC that terminated with:\n status = UNAVAILABLE>"

        def details(self) -> str:
            return "Socket closed"

    assert peer_process.complaint(BrokenOffError()) == "Socket closed"
    assert peer_process.complaint(ValueError("one\ntwo")) == "one"
    assert peer_process.complaint(ValueError()) == "ValueError"
