"""Small floors as map_server files, drawn as text: `#` is wall, everything else free."""

from pathlib import Path

import numpy as np
from PIL import Image

from simulator.fleet_scenario import FleetScenario, HiddenBlockade, RobotStart, RobotType, Target

EXPLORER, CLEARER = RobotType("explorer", beams=72), RobotType("clearer", beams=72)

TWO_ROOMS = """
####################
#........#.........#
#........#.........#
#..................#
#........#.........#
#........#.........#
####################
"""
"""Two rooms of 8 x 5 m and a gap of 1 m between them; a character is a metre."""


def write_floor(folder: Path, drawing: str, resolution_m: float = 0.1) -> Path:
    """Writes a floor whose characters are squares of a metre; the last line is the lowest."""
    lines = drawing.strip().splitlines()
    walls = np.array([[cell == "#" for cell in line] for line in lines])
    scale = round(1 / resolution_m)
    image = np.where(np.kron(walls, np.ones((scale, scale), dtype=bool)), 0, 254)
    Image.fromarray(image.astype(np.uint8)).save(folder / "floor.pgm")
    path = folder / "floor.yaml"
    path.write_text(
        f"image: floor.pgm\nresolution: {resolution_m}\norigin: [0.0, 0.0, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return path


def two_rooms(folder: Path, *, blocked: bool = True, seed: int = 0) -> FleetScenario:
    """An explorer and a clearer in the left room, targets in both, perhaps a blockade between."""
    blockade = HiddenBlockade("blockade_1", ((9.5, 3.0), (9.5, 4.0)), 5.0)
    return FleetScenario(
        name="two rooms",
        map_path=write_floor(folder, TWO_ROOMS),
        robot_types=(EXPLORER, CLEARER),
        robots=(
            RobotStart("explorer_1", "explorer", (2.0, 2.0, 0.0)),
            RobotStart("clearer_1", "clearer", (2.0, 5.0, 0.0)),
        ),
        targets=(Target("near", (4.0, 5.0)), Target("far", (17.0, 2.0))),
        blockades=(blockade,) if blocked else (),
        seed=seed,
    )
