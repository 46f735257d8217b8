"""Random disaster problems on drawn buildings, as plain PDDL with path costs as fluents.

The team starts in the largest area that is connected while every blockade stands; up to half of
the targets lie behind blockades, many of which have a way around. Costs are those that the grid's
attachment tells, in whole seconds; clearers are half as fast.
"""

from __future__ import annotations

from math import ceil, isfinite
from random import Random

from scenarios.benchmarks.planner.team_instances import numbered, problem_text
from scenarios.maps.floor_plan import FloorPlan
from scenarios.maps.generators import GENERATORS
from scenarios.maps.placement import Placement, PlacementParameters, place
from scenarios.maps.starts import draw_starts
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World

RADIUS_M = 0.3
SPEED_M_S = 0.25
CLEARING_S = (90, 380)
"""Time that clearing a blockade takes."""
ATTEMPTS = 20
"""Buildings that are drawn until one has room for all."""


def disaster(building: str, team: tuple[int, int], targets: int, blockades: int, seed: int) -> str:
    """A problem of the domain `team_instances.DISASTER`: explorers and clearers in a building.

    Raises:
        ValueError: if none of the buildings drawn has room for so many targets and blockades.
    """
    explorers, clearers = team
    plan, placement = _furnished(building, targets, blockades, seed)
    random = Random(f"{building} {team} {targets} {blockades} {seed}")
    cells = plan.cells()
    starts = draw_starts(
        cells,
        plan.resolution_m,
        (0.0, 0.0),
        robots=explorers + clearers,
        clearance_m=RADIUS_M,
        seed=f"{building} {seed}",
        blockades_m=[blockade.segment_m for blockade in placement.blockades],
    )
    spots = {f"s{k}": Location((x_m, y_m)) for k, (x_m, y_m, _) in enumerate(starts)}
    spots |= {f"t{k}": Location(one.position_m) for k, one in enumerate(placement.targets)}
    closed = {
        f"b{k}": Blockade(
            f"b{k}", one.segment_m, 10.0 * random.randint(*(s // 10 for s in CLEARING_S))
        )
        for k, one in enumerate(placement.blockades)
    }
    doors = {name: Location(one.centre_m, blockade=name) for name, one in closed.items()}
    model = RobotModel("robot", radius_m=RADIUS_M, speed_m_s=SPEED_M_S)
    world = World(GridMap(cells, plan.resolution_m), spots | doors, {"robot": model}, closed)
    costs = PathCosts(world)
    places = list(world.locations)
    pairs = [(one, other) for one in places for other in places if one != other]
    times_s = costs.many([("robot", *pair) for pair in pairs])
    robots = [(numbered("e", explorers), 1), (numbered("c", clearers), 2)]
    init = []
    for (one, other), time_s in zip(pairs, times_s, strict=True):
        if isfinite(time_s):
            init.append(f"(way {one} {other})")
            init += [
                f"(= (cost {robot} {one} {other}) {factor * ceil(time_s)})"
                for group, factor in robots
                for robot in group
            ]
    team_names = [robot for group, _ in robots for robot in group]
    init += [f"(at {robot} s{k})" for k, robot in enumerate(team_names)]
    init += [f"(= (size {name}) {one.clear_duration_s:.0f})" for name, one in closed.items()]
    objects = {
        "explorer": numbered("e", explorers),
        "clearer": numbered("c", clearers),
        "spot": list(spots),
        "blockade": list(closed),
    }
    return problem_text("floor", objects, init, targets)


def _furnished(
    building: str, targets: int, blockades: int, seed: int
) -> tuple[FloorPlan, Placement]:
    """The first building of those drawn for a seed that has room for all."""
    draw, drawn = GENERATORS[building]
    parameters = PlacementParameters(
        targets=targets, blockades=blockades, target_rooms=drawn.target_rooms
    )
    for attempt in range(ATTEMPTS):
        plan = draw(ATTEMPTS * seed + attempt)
        try:
            return plan, place(plan, seed, parameters)
        except ValueError:
            continue
    raise ValueError(f"no {building} has room for {targets} targets and {blockades} blockades")
