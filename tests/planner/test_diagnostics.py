"""What becomes of panics of the core."""

import pytest

from planner import InternalError, PlannerError, _core
from planner.diagnostics import without_panics


def test_a_panic_is_an_internal_error_with_its_place(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InternalError, match="on purpose") as caught, without_panics():
        _core.panic_on_purpose("on purpose")
    assert "panic.rs:" in str(caught.value)
    assert isinstance(caught.value, PlannerError)
    assert caught.value.outcome.row.exit_code == 30
    assert capfd.readouterr().err == ""
