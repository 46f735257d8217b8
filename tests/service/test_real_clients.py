"""The programs that people use against planning services, where they are installed.

`planutils` on the path (`pip install planutils requests`), and `pddl-workspace` for Node (`npm
install pddl-workspace`, with `NODE_PATH` naming its node_modules). What they send and read is also
in `test_editors`, as recorded requests.
"""

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from test_client import listening
from travelling import DOMAIN, problem

from service.settings import Settings

pytestmark = pytest.mark.slow
PROBLEM = problem(4).rstrip().removesuffix(")") + "(:metric minimize (total-time)))\n"
PARSE = """
const {parser} = require("pddl-workspace");
const text = require("fs").readFileSync(0, "utf8");
const plan = new parser.PddlPlanParser().parseText(text, 0.001);
const steps = plan.steps.map(s => ({name: `(${s.getFullActionName()})`,
  time: s.getStartTime(), duration: s.getDuration() || 0}));
console.log(JSON.stringify({domain: plan.domainName, problem: plan.problemName,
  metric: plan.metric, steps}));
"""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    settings = Settings(database_url="sqlite://", planning_processes=1)
    with listening(settings) as port:
        yield f"http://127.0.0.1:{port}"


@pytest.fixture
def planutils(address: str, tmp_path: Path) -> list[str]:
    """The command, set up to ask this server."""
    found = shutil.which("planutils")
    if found is None:
        pytest.skip("planutils is not installed (pip install planutils requests)")
    settings = tmp_path / ".planutils" / "settings.json"
    settings.parent.mkdir()
    (settings.parent / "packages").mkdir()
    settings.write_text(
        json.dumps({"PAAS_SERVER": address, "PAAS_SERVER_LIMIT": 100, "installed": []})
    )
    return [found]


def run(command: list[str], home: Path) -> str:
    done = subprocess.run(
        command,
        cwd=home,
        env={**os.environ, "HOME": str(home)},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_planutils_lists_and_solves(planutils: list[str], tmp_path: Path) -> None:
    listed = run([*planutils, "remote-list"], tmp_path)
    assert "marsupial" in listed
    assert "{domain}" in listed
    (tmp_path / "domain.pddl").write_text(DOMAIN)
    (tmp_path / "problem.pddl").write_text(PROBLEM)
    words = ["remote", "marsupial", "domain.pddl", "problem.pddl", "5", "1"]
    printed = run([*planutils, *words], tmp_path)
    assert "(go r" in printed
    assert "(go r" in (tmp_path / "plan").read_text()


def test_the_npm_parser_reads_our_plans(address: str) -> None:
    if shutil.which("node") is None:
        pytest.skip("node is not installed (Debian: apt-get install nodejs)")
    there = subprocess.run(
        ["node", "-e", 'require.resolve("pddl-workspace")'], capture_output=True, check=False
    )
    if there.returncode != 0:
        pytest.skip("pddl-workspace is not installed (npm install pddl-workspace, set NODE_PATH)")
    body = {"domain": DOMAIN, "problem": PROBLEM}
    answer: dict[str, Any] = httpx.post(f"{address}/solve", json=body, timeout=60.0).json()
    text = answer["result"]["output"]
    parsed = json.loads(
        subprocess.run(
            ["node", "-e", PARSE], input=text, capture_output=True, text=True, check=True
        ).stdout
    )
    assert (parsed["domain"], parsed["problem"]) == ("errands", "round")
    told = answer["result"]["plan"]
    assert [step["name"] for step in parsed["steps"]] == [step["name"] for step in told]
    for ours, theirs in zip(told, parsed["steps"], strict=True):
        assert theirs["time"] == pytest.approx(ours["time"], abs=0.0011)
        assert theirs["duration"] == pytest.approx(ours["duration"], abs=0.0011)
    ends = [step["time"] + step["duration"] for step in told]
    assert parsed["metric"] == pytest.approx(max(ends), abs=0.0021)
