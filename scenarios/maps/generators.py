"""All generators of buildings by name, with what is placed in them."""

from __future__ import annotations

from collections.abc import Callable

from scenarios.maps import (
    hospital,
    large_rooms,
    maze,
    office,
    power_plant,
    random_building,
    small_rooms,
)
from scenarios.maps.floor_plan import FloorPlan
from scenarios.maps.placement import PlacementParameters

GENERATORS: dict[str, tuple[Callable[[int], FloorPlan], PlacementParameters]] = {
    "hospital": (hospital.draw, PlacementParameters()),
    "power_plant": (
        power_plant.draw,
        PlacementParameters(targets=13, blockades=58, target_rooms=("reactor", "control")),
    ),
    "office": (
        office.draw,
        PlacementParameters(targets=24, blockades=0, sealed_share=0.0),
    ),
    "maze": (
        maze.draw,
        PlacementParameters(
            targets=16, blockades=0, sealed_share=0.0, target_rooms=("core", "corridor")
        ),
    ),
    "small_rooms": (small_rooms.draw, PlacementParameters(targets=8, blockades=4)),
    "large_rooms": (large_rooms.draw, PlacementParameters(targets=8, blockades=4)),
    "random_building": (random_building.draw, PlacementParameters()),
}
