"""What a new blockade makes the path costs of the others forget."""

from dataclasses import replace
from itertools import permutations

import numpy as np

from scenarios.benchmarks.attachments.hospital import hospital_world
from scenarios.benchmarks.attachments.measuring import cpu_s, table
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.world import World


def run(*, quick: bool) -> str:
    """Each blockade of the hospital in turn is discovered last; the one of the quick run is the
    first."""
    world = hospital_world()
    names = sorted(world.blockades)[: 3 if quick else None]
    rows = []
    for name in names:
        fields, share, touched, again_s, fresh_s = discovery(world, name)
        rows.append([name, len(world.locations) - 1, fields, share, touched, fresh_s / again_s])
    few = [row for row in rows if float(str(row[4])) <= 0.1]
    few_shares = [float(str(row[3])) for row in few]
    summary = (
        f"Blockades that touch at most a tenth of the paths: {len(few)} of {len(rows)}; "
        f"sources recomputed there: {np.mean(few_shares):.1%} on average, at most "
        f"{max(few_shares):.1%}."
        if few
        else "No blockade touches at most a tenth of the paths."
    )
    columns = [
        "blockade", "sources before", "searches after", "share", "paths touched", "all anew / kept",
    ]  # fmt: skip
    return table("Replanning after one new blockade, hospital", columns, rows) + "\n\n" + summary


def discovery(world: World, name: str) -> tuple[int, float, float, float, float]:
    """Searches, their share of the sources, share of paths touched, CPU times kept and anew [s]."""
    places = {key: place for key, place in world.locations.items() if key != name}
    blockades = {key: one for key, one in world.blockades.items() if key != name}
    before = PathCosts(replace(world, locations=places, blockades=blockades))
    robot = sorted(world.robots)[0]
    old_calls = [(robot, start, goal) for start, goal in permutations(places, 2)]
    before.many(old_calls)
    calls = [(robot, start, goal) for start, goal in permutations(world.locations, 2)]

    def replan() -> PathCosts:
        after = before.after(world)
        after.many(calls)
        return after

    again_s, after = cpu_s(replan, repeats=3)
    fresh_s, _ = cpu_s(lambda: PathCosts(world).many(calls), repeats=3)
    statistics = after.statistics
    touched = statistics.forgotten / (statistics.forgotten + statistics.kept)
    return statistics.fields, statistics.fields / len(places), touched, again_s, fresh_s
