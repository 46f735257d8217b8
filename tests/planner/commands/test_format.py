"""`marsupial format`: in place, --check, standard input; domains of the project are formatted."""

from pathlib import Path

import pytest
from typer import Typer
from typer.testing import CliRunner, Result

from planner.commands.format import format_files

UGLY = "(define (domain d) ; why\n(:predicates (p) (q)))"
NEAT = "(define (domain d) ; why\n  (:predicates\n    (p)\n    (q)))\n"


def run(*words: str, stdin: str | None = None) -> Result:
    app = Typer()
    app.command()(format_files)
    return CliRunner().invoke(app, list(words), input=stdin)


def test_files_are_formatted_in_place(tmp_path: Path) -> None:
    path = tmp_path / "d.pddl"
    path.write_text(UGLY)
    assert run(str(path)).exit_code == 0
    assert path.read_text() == NEAT
    assert run(str(path)).output == ""


def test_check_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "d.pddl"
    path.write_text(UGLY)
    result = run("--check", str(path))
    assert (result.exit_code, path.read_text()) == (1, UGLY)
    path.write_text(NEAT)
    assert run("--check", str(path)).exit_code == 0


def test_standard_input_goes_to_standard_output() -> None:
    assert run("-", stdin=UGLY).stdout == NEAT


def test_a_faulty_file_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "d.pddl"
    path.write_text("(define (domain d)")
    result = run(str(path))
    assert result.exit_code == 1
    assert path.read_text() == "(define (domain d)"
    assert "PDDL001" in result.output


@pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00", b"\x00" * 1000, b"(" * 100_000])
def test_hostile_files_are_refused_or_kept(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "d.pddl"
    path.write_bytes(content)
    result = run(str(path))
    assert result.exit_code in {0, 1}
    assert path.read_bytes() == content
