import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domains.naming import Names


def test_plain_ids_stay_as_they_are() -> None:
    names = Names(["explorer_1", "target-2"])
    assert names.name("explorer_1") == "explorer_1"
    assert names.name("target-2") == "target-2"


def test_a_plain_id_keeps_its_name_though_another_would_become_it_first() -> None:
    names = Names(["Robot 1", "robot_1"])
    assert names.name("robot_1") == "robot_1"
    assert names.name("Robot 1") == "robot_1_2"


def test_an_id_given_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="'r1' names two things"):
        Names(["r1", "r1"])


@given(st.lists(st.text(), unique=True))
def test_names_are_pddl_names_and_lead_back_to_their_ids(ids: list[str]) -> None:
    names = Names(ids)
    for identifier in ids:
        name = names.name(identifier)
        assert re.fullmatch(r"[a-z][a-z0-9_-]*", name)
        assert names.id(name) == identifier
