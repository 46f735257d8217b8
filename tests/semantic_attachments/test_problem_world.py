"""A world from a problem's fluents."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from semantic_attachments.problem_world import world_of_problem
from semantic_attachments.world import Blockade, GridMap, Location, RobotModel

GRID = GridMap(np.zeros((10, 10), np.int8), 1.0)


@dataclass
class View:
    objects: dict[str, list[str]] = field(
        default_factory=lambda: {
            "clearer_1": ["clearer"],
            "target_1": ["mission_target"],
            "rubble": ["blockade"],
            "hope": ["feeling"],
        }
    )
    facts: frozenset[tuple[str, ...]] = frozenset({("charger", "target_1")})
    fluents: dict[tuple[str, ...], float] = field(
        default_factory=lambda: {
            ("x", "target_1"): 1.5,
            ("y", "target_1"): 2.5,
            ("x-from", "rubble"): 3.0,
            ("y-from", "rubble"): 1.0,
            ("x-to", "rubble"): 5.0,
            ("y-to", "rubble"): 1.0,
            ("clear-duration", "rubble"): 12.0,
            ("speed", "clearer_1"): 0.7,
            ("radius", "clearer_1"): 0.3,
        }
    )


def test_fluents_become_geometry() -> None:
    world = world_of_problem(View(), GRID)
    assert dict(world.locations) == {
        "target_1": Location((1.5, 2.5), charger=True),
        "rubble": Location((4.0, 1.0), blockade="rubble"),
    }
    assert dict(world.blockades) == {"rubble": Blockade("rubble", ((3.0, 1.0), (5.0, 1.0)), 12.0)}
    assert dict(world.robots) == {"clearer_1": RobotModel("clearer", 0.3, 0.7)}


def test_robot_types_say_what_fluents_cannot() -> None:
    model = RobotModel("clearer", radius_m=0.5, speed_m_s=9.0, enters=("floor", "stairs"))
    world = world_of_problem(View(), GRID, {"clearer": model})
    assert world.robots["clearer_1"].enters == ("floor", "stairs")
    assert world.robots["clearer_1"].speed_m_s == 0.7


@pytest.mark.parametrize("missing", [("y", "target_1"), ("x-to", "rubble")])
def test_a_missing_fluent_is_named(missing: tuple[str, str]) -> None:
    view = View()
    del view.fluents[missing]
    with pytest.raises(ValueError, match=f"\\({missing[0]} {missing[1]}\\)"):
        world_of_problem(view, GRID)
