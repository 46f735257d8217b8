"""Which mission is meant, and where it is looked for."""

from pathlib import Path
from typing import Any

import pytest

from scenarios.exit_codes import CommandError
from scenarios.replay.log import chosen, events_of

KNOWN = ["c0ffee01", "c0ffee02", "abba"]


@pytest.mark.parametrize(
    ("mission", "meant"),
    [("latest", "c0ffee01"), ("abba", "abba"), ("a", "abba"), ("c0ffee02", "c0ffee02")],
)
def test_a_mission_is_named_by_as_much_of_its_id_as_it_takes(mission: str, meant: str) -> None:
    assert chosen(mission, KNOWN) == meant


@pytest.mark.parametrize(
    ("mission", "known", "word"),
    [("c0ffee", KNOWN, "more of the id"), ("x", KNOWN, "abba"), ("latest", [], "no mission yet")],
)
def test_a_mission_that_is_none_gets_a_sentence(mission: str, known: list[str], word: str) -> None:
    with pytest.raises(CommandError, match=word):
        chosen(mission, known)


def test_events_come_from_a_database(told: tuple[str, dict[str, Any]]) -> None:
    url, mission = told
    events = events_of(mission["id"][:10], db=url)
    assert events[0].kind == "mission-created"
    assert events[-1].kind == "mission-closed"


def test_no_database_is_made_by_looking_for_one(tmp_path: Path) -> None:
    path = tmp_path / "none.sqlite"
    with pytest.raises(CommandError, match="there is no database"):
        events_of("latest", db=f"sqlite:///{path}")
    assert not path.exists()
    path.write_text("this is no database")
    with pytest.raises(CommandError, match="is not a database"):
        events_of("latest", db=f"sqlite:///{path}")
    with pytest.raises(CommandError, match="sqlite:///FILE"):
        events_of("latest", db="nonsense")
