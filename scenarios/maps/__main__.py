"""Draws a map: `python -m scenarios.maps hospital --seed 1 --out scenarios/maps/hospital`."""

from __future__ import annotations

import argparse
from pathlib import Path

from scenarios.maps.files import write_annotations, write_plan
from scenarios.maps.generators import GENERATORS
from scenarios.maps.placement import place


def draw(kind: str, seed: int, folder: Path) -> float:
    """Draws and annotates a map, writes its three files and returns the share of sealed targets."""
    generator, parameters = GENERATORS[kind]
    plan = generator(seed)
    placement = place(plan, seed, parameters)
    write_plan(folder, kind, plan)
    write_annotations(folder, kind, placement)
    return placement.sealed_fraction


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m scenarios.maps", description=__doc__)
    parser.add_argument("kind", choices=sorted(GENERATORS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="folder to write into")
    arguments = parser.parse_args()
    sealed = draw(arguments.kind, arguments.seed, arguments.out)
    print(f"{arguments.out}: {sealed:.0%} of the targets are sealed by blockades")


if __name__ == "__main__":
    main()
