"""The command line: each command has help, faults are sentences with an exit code."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from scenarios import application, cli
from scenarios.exit_codes import FAULT, INPUT_ERROR, USAGE_ERROR, CommandError

ROOT = Path(cli.__file__).parents[1]


def marsupial(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "scenarios.cli", *words],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "TERM": "dumb", "COLUMNS": "100"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_help_names_every_command() -> None:
    shown = CliRunner().invoke(application.application(["--help"]), ["--help"])
    assert shown.exit_code == 0
    for name in application.COMMANDS:
        assert name in shown.output


@pytest.mark.parametrize("name", sorted(application.COMMANDS))
def test_each_command_explains_itself(name: str) -> None:
    words = [name, "--help"]
    shown = CliRunner().invoke(application.application(words), words)
    assert shown.exit_code == 0, shown.output
    assert len(shown.output) > 200


def test_wrong_usage_has_a_code_of_its_own() -> None:
    """Not Click's 2: that is a plan found before the time was up."""
    for words in (["plan"], ["run", "x.toml", "--seed", "many"], ["fly"], ["run", "--nonsense"]):
        run = marsupial(*words)
        assert run.returncode == USAGE_ERROR, words
        assert "Traceback" not in run.stderr
        assert "Usage" in run.stderr


def test_without_words_there_is_help() -> None:
    run = marsupial()
    assert run.returncode == 0
    assert "Usage" in run.stdout


def test_missing_scenario_is_a_sentence() -> None:
    run = marsupial("run", "none.toml")
    assert run.returncode == INPUT_ERROR
    assert run.stderr == "marsupial: none.toml: no such file; check the path\n"


def test_a_fault_is_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def breaks(_: object) -> None:
        raise RuntimeError("wires crossed")

    monkeypatch.setattr(cli, "run", breaks)
    with pytest.raises(SystemExit) as ended:
        cli.main(["plan"])
    assert ended.value.code == FAULT
    assert "RuntimeError: wires crossed" in capsys.readouterr().err
    with pytest.raises(RuntimeError):
        cli.main(["--debug", "plan"])


def test_expected_failures_keep_their_exit_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fails(_: object) -> None:
        raise CommandError("the team cannot finish", 12)

    monkeypatch.setattr(cli, "run", fails)
    with pytest.raises(SystemExit) as ended:
        cli.main(["run"])
    assert ended.value.code == 12
    assert capsys.readouterr().err == "marsupial: the team cannot finish\n"


def test_somebody_elses_service_is_noticed(tmp_path: Path) -> None:
    """A package of the same name earlier on the path would be imported instead of ours."""
    (tmp_path / "service").mkdir()
    (tmp_path / "service" / "__init__.py").write_text("", encoding="utf-8")
    program = "from scenarios import cli; print(cli.someone_elses_room())"
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}
    run = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert str(tmp_path / "service") in run.stdout
    assert "virtual environment of its own" in run.stdout
    assert cli.someone_elses_room() is None


def test_a_command_imports_only_its_room() -> None:
    """Quick start: asking for one command must not import the rooms of the others."""
    program = (
        "import sys; from scenarios.application import application; "
        "application(['run', 'x.toml']); "
        "heavy = {'fastapi', 'scipy', 'pymunk', 'unified_planning', 'pydantic', 'rich.progress'}; "
        "print(sorted(heavy & set(sys.modules)))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.strip() == "[]"


def test_a_first_plan_waits_for_no_library_it_does_not_use() -> None:
    program = (
        "import sys; from scenarios.cli import run; "
        "code = run(['plan', 'domains/disaster/domain.pddl', "
        "'domains/disaster/problems/hospital-15.pddl', "
        "'--map', 'scenarios/maps/hospital/hospital.yaml', '--first']); "
        "heavy = {'typer', 'pydantic', 'rich', 'scipy', 'ompl', 'importlib.metadata', "
        "'semantic_attachments.motion'}; "
        "print(code, sorted(heavy & set(sys.modules)))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.splitlines()[-1] == "0 []"
