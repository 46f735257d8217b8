"""Writes the example problems of domains/: `python -m scenarios.examples`.

They are what the service poses at the beginning of a mission, with all blockades known, so that
planning them from the command line is
planning for a real building. Drawn from the maps of scenarios/maps and from two small floors
defined here.
"""

import tomllib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import domains
from domains import Activity, BlockadeState, MeetingPoint, MissionState, RobotState, Target
from scenarios.maps.files import write_map
from semantic_attachments.grid_map import GridMap
from semantic_attachments.map_server import read_map
from semantic_attachments.robot_model import RobotModel

ROOT = Path(__file__).parent.parent
HOSPITAL = Path(__file__).parent / "maps" / "hospital"

DISASTER_TYPES = {
    name: RobotModel(name, radius_m=0.3, speed_m_s=1.0) for name in ("explorer", "clearer")
}
# A carrier is twice as fast as a rover (Wurm, section 3.6.2), and too wide for the doors of rover
# rooms.
MARSUPIAL_TYPES = {
    "carrier": RobotModel("carrier", radius_m=0.6, speed_m_s=1.0, capacity=2),
    "rover": RobotModel("rover", radius_m=0.25, speed_m_s=0.5),
}


def passage_cells() -> NDArray[np.int8]:
    """Two rooms and a narrow passage between them (Wurm, figure 3.16), 14 x 6 m at 0.1 m."""
    cells = np.full((60, 140), 100, np.int8)
    cells[2:58, 2:60] = 0
    cells[2:58, 80:138] = 0
    cells[25:35, 60:80] = 0
    return cells


def annex_cells() -> NDArray[np.int8]:
    """A hall of 30 x 6 m with six rooms above and below, whose doors are 0.9 m wide: 30 x 20 m at
    0.1 m."""
    cells = np.full((200, 300), 100, np.int8)
    cells[70:130, 2:298] = 0
    for column in range(3):
        left = 2 + column * 100
        for low, high, door in ((2, 66, 66), (134, 198, 130)):
            cells[low:high, left : left + 94] = 0
            cells[door : door + 4, left + 42 : left + 51] = 0
    return cells


def passage() -> MissionState:
    """One explorer, one clearer, a blocked passage (Wurm, section 3.6.9)."""
    return MissionState(
        time_s=0.0,
        robots=(
            RobotState("explorer_1", "explorer", (1.5, 3.0)),
            RobotState("clearer_1", "clearer", (1.5, 5.0)),
        ),
        targets=(Target("target_1", (12.5, 1.5)),),
        blockades=(BlockadeState("blockade_1", ((7.0, 2.5), (7.0, 3.5)), 20.0),),
    )


def hospital(targets: int, blockades: int) -> MissionState:
    """Two explorers and two clearers on the hospital map; the first targets and blockades of its
    list."""
    annotations = tomllib.loads((HOSPITAL / "hospital.toml").read_text(encoding="utf-8"))
    starts = [(20.1, 31.3), (21.5, 31.3), (20.1, 32.3), (21.5, 32.3)]
    robots = zip(("explorer_1", "explorer_2", "clearer_1", "clearer_2"), starts, strict=True)
    return MissionState(
        time_s=0.0,
        robots=tuple(RobotState(name, name.split("_")[0], start) for name, start in robots),
        targets=tuple(
            Target(target["id"], (target["position_m"][0], target["position_m"][1]))
            for target in annotations["targets"][:targets]
        ),
        blockades=tuple(
            BlockadeState(
                blockade["id"],
                (tuple(blockade["segment_m"][0]), tuple(blockade["segment_m"][1])),
                blockade["clear_duration_s"],
            )
            for blockade in annotations["blockades"][:blockades]
        ),
    )


def annex(carriers: int, rovers_each: int, rooms: int) -> MissionState:
    """Carriers in the hall, a target in each of the first rooms and one at either end of the
    hall."""
    places = [(2.6 + 10 * column, y) for y in (3.4, 16.6) for column in range(3)]
    doors = [(4.9 + 10 * column, y) for y in (8.0, 12.0) for column in range(3)]
    robots = []
    for number in range(1, carriers + 1):
        carrier, start = f"carrier_{number}", (12.0 + 3 * number, 10.0)
        robots.append(RobotState(carrier, "carrier", start))
        robots += [
            RobotState(f"rover_{number}_{rover}", "rover", start, Activity.DOCKED, carrier)
            for rover in range(1, rovers_each + 1)
        ]
    ends = (Target("hall_west", (1.5, 10.0)), Target("hall_east", (28.5, 10.0)))
    return MissionState(
        time_s=0.0,
        robots=tuple(robots),
        targets=(*ends, *(Target(f"room_{i + 1}", places[i]) for i in range(rooms))),
        meeting_points=tuple(MeetingPoint(f"door_{i + 1}", doors[i]) for i in range(rooms)),
        capacities={robot.id: 2 for robot in robots if robot.type == "carrier"},
    )


def write(root: Path = ROOT) -> list[Path]:
    """Writes every example below `root` (the project's folder) and returns the paths of the
    problems."""
    disaster, marsupial = root / "domains/disaster/problems", root / "domains/marsupial/problems"
    passage_map = read_map(write_map(disaster, "passage", passage_cells(), 0.1))
    annex_map = read_map(write_map(marsupial, "annex", annex_cells(), 0.1))
    hospital_map = read_map(HOSPITAL / "hospital.yaml")
    return [
        _write(disaster / "passage.pddl", passage(), passage_map, DISASTER_TYPES),
        _write(disaster / "hospital-6.pddl", hospital(6, 8), hospital_map, DISASTER_TYPES),
        _write(disaster / "hospital-15.pddl", hospital(15, 18), hospital_map, DISASTER_TYPES),
        _write(marsupial / "annex-1x1.pddl", annex(1, 1, 2), annex_map, MARSUPIAL_TYPES),
        _write(marsupial / "annex-1x2.pddl", annex(1, 2, 4), annex_map, MARSUPIAL_TYPES),
        _write(marsupial / "annex-2x2.pddl", annex(2, 2, 6), annex_map, MARSUPIAL_TYPES),
    ]


def _write(path: Path, state: MissionState, grid: GridMap, types: dict[str, RobotModel]) -> Path:
    formulation = domains.load(path.parent.parent.name)
    world = formulation.world(state, grid, types)
    text = formulation.problem(world, state, name=path.stem)
    path.write_text(text, encoding="utf-8")
    return path


if __name__ == "__main__":
    for written in write():
        print(written.relative_to(ROOT))
