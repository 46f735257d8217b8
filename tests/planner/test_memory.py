"""Peak memory of a process."""

import subprocess
import sys

import pytest

SHOW = "from planner.memory import peak_mb; print(peak_mb())"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells programs apart")
def test_a_program_is_not_charged_for_what_its_parent_holds() -> None:
    held = b"x" * (300 << 20)
    begun = subprocess.run([sys.executable, "-c", SHOW], capture_output=True, check=True)
    assert 1.0 < float(begun.stdout) < len(held) / (1 << 20)
