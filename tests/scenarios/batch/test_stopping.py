"""A suite that is told to stop leaves no process behind, and says how to go on."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import scenarios

SUITE = """
name = "long"
strategies = ["planner"]
teams = [{{ carrier = 1, rover = 1 }}]
seeds = 1

[[maps]]
name = "office"
scenario = "{home}/exploration/office.toml"
"""


@pytest.mark.slow
@pytest.mark.parametrize("told_by", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "SIGINT"])
def test_no_run_goes_on_when_a_suite_is_stopped(told_by: signal.Signals, tmp_path: Path) -> None:
    file = tmp_path / "long.toml"
    file.write_text(SUITE.format(home=Path(scenarios.__file__).parent), encoding="utf-8")
    words = [sys.executable, "-m", "scenarios.cli", "bench", str(file), "--out", str(tmp_path)]
    suite = subprocess.Popen(words, stderr=subprocess.PIPE, text=True, start_new_session=True)
    try:
        deadline_s = time.monotonic() + 60.0
        # The suite, the server that runs are forked from, its helper and the run.
        while len(processes_of(suite.pid)) < 4 and time.monotonic() < deadline_s:
            time.sleep(0.1)
        assert len(processes_of(suite.pid)) >= 4
        suite.send_signal(told_by)
        _, told = suite.communicate(timeout=30.0)
        assert suite.returncode == 130
        assert "--resume" in told
        assert "Traceback" not in told
        deadline_s = time.monotonic() + 10.0
        while processes_of(suite.pid) and time.monotonic() < deadline_s:
            time.sleep(0.1)
        assert processes_of(suite.pid) == []
    finally:
        if processes_of(suite.pid):
            os.killpg(suite.pid, signal.SIGKILL)
            suite.communicate()


def processes_of(session: int) -> list[int]:
    """The processes of a session that have not ended."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            found.append(int(folder.name))
    return found
