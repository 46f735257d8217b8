"""Peers, as far as they can be tried without being installed."""

import sys
from pathlib import Path

import pytest

import planner
from planner import peers
from tests.planner.problems import MATCH_CELLAR


@pytest.fixture
def problem() -> planner.Problem:
    return planner.read_problem(MATCH_CELLAR.domain, MATCH_CELLAR.problem)


def program(path: Path, text: str) -> None:
    """A program in Python."""
    path.write_text(f"#!{sys.executable}\n{text}")
    path.chmod(0o700)


def kairos(folder: Path, monkeypatch: pytest.MonkeyPatch, plans: list[str]) -> None:
    """Puts a stand-in on the path that writes these plans where kairos writes its own."""
    program(
        folder / "kairos",
        f"""
import pathlib, sys
home = pathlib.Path(sys.argv[sys.argv.index("--output") + 1])
assert pathlib.Path(sys.argv[2]).read_text().startswith("(define (domain")
for number, text in enumerate({plans!r}, 1):
    pathlib.Path(f"{{home}}.{{number}}").write_text(text)
""",
    )
    monkeypatch.setenv("PATH", str(folder))


@pytest.mark.skipif(peers.shutil.which("kairos") is not None, reason="kairos is installed")
def test_plans_of_a_peer_are_validated(
    problem: planner.Problem,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    wrong = MATCH_CELLAR.plan.replace("3.002", "6.000")
    kairos(tmp_path, monkeypatch, ["; cost = 8\n" + MATCH_CELLAR.plan, wrong])
    result = peers.solve_with_peer("kairos", problem, {}, 5)
    assert result.outcome is planner.Outcome.SOLVED
    assert [plan.makespan for plan in result.plans] == [8.0]
    assert "kairos: plan 2 is not valid: happening 5" in capsys.readouterr().err


def test_a_peer_without_plan_is_no_success(
    problem: planner.Problem, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kairos(tmp_path, monkeypatch, [])
    monkeypatch.setattr(peers.sys, "executable", "/nowhere/python")
    assert not peers.solve_with_peer("kairos", problem, {}, 5).outcome.solved


def test_brackets_of_others_are_understood() -> None:
    text = (
        "; Time 0.02\n0.0002:   (MOVE C A B) [364.0000])\n\n364.0005:   (CLEAR C B) [150.0000])\n"
    )
    assert peers._STEP.findall(text) == [
        ("0.0002", "(MOVE C A B)", "364.0000"),
        ("364.0005", "(CLEAR C B)", "150.0000"),
    ]


@pytest.mark.parametrize("name", sorted(peers.PEERS))
def test_an_absent_peer_is_one_sentence(
    name: str, problem: planner.Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(peers.sys, "executable", "/nowhere/python")
    monkeypatch.setattr(peers, "find_spec", lambda _: None)
    with pytest.raises(peers.PeerError, match=f"^the engine {name} is not installed: pip install"):
        peers.solve_with_peer(name, problem, {}, 1)
