"""The wheel holds everything: built, installed elsewhere and run there."""

import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def run(*words: str, cwd: Path) -> str:
    """Runs a command without any trace of this checkout in its environment."""
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
    done = subprocess.run(
        words, cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{' '.join(words)}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual environment with the wheel; dependencies come from the tests' own environment."""
    folder = tmp_path_factory.mktemp("elsewhere")
    words = ["-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir"]
    run(sys.executable, *words, str(folder), str(ROOT), cwd=ROOT)
    (wheel,) = folder.glob("marsupial-*.whl")
    venv.create(folder / "venv", with_pip=True)
    python = folder / "venv" / "bin" / "python"
    run(str(python), "-m", "pip", "install", "--quiet", "--no-deps", str(wheel), cwd=folder)
    dependencies = Path(sys.executable).parent.parent.glob("lib/python3*/site-packages")
    (site,) = (folder / "venv").glob("lib/python3*/site-packages")
    # Behind the wheel on the path, and without the editable install's finder, which a .pth starts.
    (site / "dependencies.pth").write_text("\n".join(map(str, dependencies)), encoding="utf-8")
    return folder


@pytest.mark.slow
def test_installed_wheel_plans_and_runs(elsewhere: Path) -> None:
    marsupial = str(elsewhere / "venv" / "bin" / "marsupial")
    python = str(elsewhere / "venv" / "bin" / "python")
    place = run(python, "-c", "import planner; print(planner.__file__)", cwd=elsewhere)
    assert place.startswith(str(elsewhere))
    assert "marsupial 0" in run(marsupial, "--version", cwd=elsewhere)
    printed = run(marsupial, "demo", "--out", str(elsewhere / "out"), cwd=elsewhere)
    assert "completed" in printed
    assert list((elsewhere / "out").glob("*.html"))
