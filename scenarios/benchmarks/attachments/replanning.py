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
    rows = [[name, *discovery(world, name)] for name in names]
    few = [row for row in rows if float(str(row[3])) <= 0.1]
    summary = "No blockade touches at most a tenth of the paths."
    if few:
        anew, repaired, cells = ([float(str(row[i])) for row in few] for i in (4, 5, 6))
        summary = (
            f"Blockades that touch at most a tenth of the paths: {len(few)} of {len(rows)}. There, "
            f"{np.mean(anew):.1%} of the trees are grown anew (at most {max(anew):.1%}; that of "
            f"the blockade's own place is 2.8 %), {np.mean(repaired):.1%} repaired; "
            f"cells computed for repairs: {np.mean(cells):.1%} of those of all trees "
            f"(at most {max(cells):.1%})."
        )
    columns = [
        "blockade", "trees before", "grown anew", "paths touched", "share anew", "share repaired",
        "cells repaired", "all anew / kept",
    ]  # fmt: skip
    return table("Replanning after one new blockade, hospital", columns, rows) + "\n\n" + summary


def discovery(world: World, name: str) -> list[object]:
    """Trees, those grown anew; shares: of paths touched, of trees anew and repaired, of cells."""
    places = {key: place for key, place in world.locations.items() if key != name}
    blockades = {key: one for key, one in world.blockades.items() if key != name}
    before = PathCosts(replace(world, locations=places, blockades=blockades))
    robot = sorted(world.robots)[0]
    before.many([(robot, start, goal) for start, goal in permutations(places, 2)])
    calls = [(robot, start, goal) for start, goal in permutations(world.locations, 2)]

    def replan() -> PathCosts:
        after = before.after(world)
        after.many(calls)
        return after

    again_s, after = cpu_s(replan, repeats=3)
    fresh_s, _ = cpu_s(lambda: PathCosts(world).many(calls), repeats=3)
    done, trees = after.statistics, len(places)
    free = int((world.grid.cells == 0).sum())
    return [
        trees,
        done.fields,
        done.forgotten / (done.forgotten + done.kept),
        done.fields / trees,
        done.repaired / trees,
        done.cells_repaired / (trees * free),
        fresh_s / again_s,
    ]
