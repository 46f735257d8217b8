"""Path costs between all pairs of 100 places."""

from functools import partial
from itertools import permutations

import numpy as np

from scenarios.benchmarks.attachments.measuring import cpu_s, table
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.robot_class import GridParameters
from semantic_attachments.world import GridMap, Location, RobotModel, World

SEED = 11


def run(*, quick: bool) -> str:
    """CPU time for all pairs on a map with 15 % obstacles."""
    size, places = (200, 30) if quick else (500, 100)
    rng = np.random.default_rng(SEED)
    cells = np.where(rng.random((size, size)) < 0.15, 100, 0).astype(np.int8)
    grid = GridMap(cells, resolution_m=0.1)
    free = grid.centres_m(rng.choice(np.flatnonzero(cells.ravel() == 0), places, replace=False))
    locations = {f"place_{i}": Location((x, y)) for i, (x, y) in enumerate(free.tolist())}
    world = World(grid, locations, {"robot": RobotModel("robot", radius_m=0.0, speed_m_s=1.0)})
    calls = [("robot", start, goal) for start, goal in permutations(locations, 2)]
    rows = []
    for name, parameters in (
        ("8-connected", GridParameters()),
        ("any angle", GridParameters(any_angle=True)),
    ):
        costs = PathCosts(world, parameters)
        first_s, values = cpu_s(partial(costs.many, calls))
        again_s, _ = cpu_s(partial(costs.many, calls))
        mean_s = float(np.mean([value for value in values if np.isfinite(value)]))
        rows.append([name, len(calls), costs.statistics.fields, first_s, again_s, mean_s])
    columns = ["paths", "pairs", "searches", "first time [s]", "again [s]", "mean cost [s]"]
    return table(f"All pairs of {places} places, {size} x {size} cells", columns, rows)
