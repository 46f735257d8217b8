"""All generators of buildings by name, with what is placed in them."""

from __future__ import annotations

from collections.abc import Callable

from scenarios.maps import hospital, power_plant, random_building
from scenarios.maps.floor_plan import FloorPlan
from scenarios.maps.placement import PlacementParameters

GENERATORS: dict[str, tuple[Callable[[int], FloorPlan], PlacementParameters]] = {
    "hospital": (hospital.draw, PlacementParameters()),
    "power_plant": (
        power_plant.draw,
        PlacementParameters(targets=13, blockades=58, target_rooms=("reactor", "control")),
    ),
    "random_building": (random_building.draw, PlacementParameters()),
}
