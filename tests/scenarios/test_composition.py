"""Start poses follow the seed, stand free and apart, and the sealed share is that of the starts."""

from itertools import combinations
from math import dist
from pathlib import Path

import pytest

import scenarios
from scenarios.composition import compose
from scenarios.maps.free_space import component_at, components
from scenarios.scenario_file import CommunicationSection, NoiseSection, read_scenario
from simulator.fleet_scenario import Communication

HOSPITAL = Path(scenarios.__file__).parent / "disaster" / "hospital.toml"


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_starts_are_free_and_apart(tmp_path: Path, seed: int) -> None:
    made = compose(read_scenario(HOSPITAL), seed=seed, folder=tmp_path)
    places = [robot.pose[:2] for robot in made.fleet.robots]
    assert len(places) == 4
    assert all(dist(a, b) >= 1.5 for a, b in combinations(places, 2))
    labels = components(made.cells, made.resolution_m, 0.3)
    assert {component_at(labels, made.resolution_m, place) for place in places} == {1}
    assert 0.3 <= made.sealed_fraction <= 0.5


def test_seed_decides(tmp_path: Path) -> None:
    scenario = read_scenario(HOSPITAL)
    one, same, other = (compose(scenario, seed=seed, folder=tmp_path).fleet for seed in (1, 1, 2))
    assert one == same
    assert [robot.pose for robot in one.robots] != [robot.pose for robot in other.robots]


def test_strategy_given_by_the_caller_wins(tmp_path: Path) -> None:
    scenario = read_scenario(HOSPITAL)
    assert compose(scenario, seed=1, folder=tmp_path).fleet.strategy == "planner"
    made = compose(scenario, seed=1, folder=tmp_path, strategy="hungarian")
    assert made.fleet.strategy == "hungarian"


def test_generated_map_brings_targets_and_blockades(tmp_path: Path) -> None:
    scenario = read_scenario(HOSPITAL.parent / "power_plant.toml")
    fleet = compose(scenario, seed=1, folder=tmp_path).fleet
    assert (len(fleet.targets), len(fleet.blockades)) == (13, 58)
    assert fleet.map_path == tmp_path / "power_plant_1.yaml"


def test_unknown_generator_is_named(tmp_path: Path) -> None:
    scenario = read_scenario(HOSPITAL.parent / "power_plant.toml")
    section = scenario.map.model_copy(update={"generator": "castle"})
    with pytest.raises(ValueError, match=r"no 'castle'; use one of hospital"):
        compose(scenario.model_copy(update={"map": section}), seed=1, folder=tmp_path)


@pytest.mark.parametrize(("share", "left"), [(0.8, 14), (0.0, 0), (1.0, 18)])
def test_blockade_share(tmp_path: Path, share: float, left: int) -> None:
    scenario = read_scenario(HOSPITAL).model_copy(update={"blockade_share": share})
    one, other = (compose(scenario, seed=seed, folder=tmp_path).fleet for seed in (1, 2))
    assert len(one.blockades) == len(other.blockades) == left
    assert (one.blockades == other.blockades) == (share in (0.0, 1.0))


def test_rovers_start_aboard_and_carriers_on_their_own_terrain(tmp_path: Path) -> None:
    scenario = read_scenario(HOSPITAL.parents[1] / "marsupial" / "maze.toml")
    fleet = compose(scenario, seed=1, folder=tmp_path).fleet
    aboard = [(robot.id, robot.carrier) for robot in fleet.robots if robot.type == "rover"]
    assert aboard == [
        ("rover_1", "carrier_1"),
        ("rover_2", "carrier_2"),
        ("rover_3", "carrier_1"),
        ("rover_4", "carrier_2"),
    ]
    alone = scenario.model_copy(update={"team": {"carrier": 0, "rover": 1}})
    with pytest.raises(ValueError, match="rover needs a carrier to ride on"):
        compose(alone, seed=1, folder=tmp_path)


def test_large_teams_find_room(tmp_path: Path) -> None:
    folder = HOSPITAL.parents[1]
    team = compose(
        read_scenario(folder / "marsupial" / "large_team.toml"), seed=1, folder=tmp_path
    ).fleet.robots
    riders = [robot.carrier for robot in team if robot.carrier is not None]
    assert (len(team), len(riders)) == (24, 18)
    assert all(riders.count(carrier) == 3 for carrier in riders)
    crowd = compose(
        read_scenario(folder / "disaster" / "stress.toml"), seed=1, folder=tmp_path
    ).fleet.robots
    assert len({robot.pose[:2] for robot in crowd}) == 100


def test_radio_and_drift_reach_the_fleet(tmp_path: Path) -> None:
    scenario = read_scenario(HOSPITAL)
    plain = compose(scenario, seed=1, folder=tmp_path).fleet
    assert plain.communication is None
    limited = scenario.model_copy(
        update={
            "communication": CommunicationSection(range_m=20.0, base_m=(3.0, 4.0)),
            "noise": NoiseSection(odometry_m=0.05),
        }
    )
    fleet = compose(limited, seed=1, folder=tmp_path).fleet
    assert fleet.communication == Communication(20.0, (3.0, 4.0), 600.0)
    assert fleet.noise.odometry_m == 0.05


@pytest.mark.parametrize(("carriers", "rovers"), [(1, 1), (2, 6), (6, 18)])
def test_carriers_hold_the_rovers_that_the_team_gives_them(
    tmp_path: Path, carriers: int, rovers: int
) -> None:
    maze = read_scenario(HOSPITAL.parents[1] / "marsupial" / "maze.toml")
    team = maze.model_copy(update={"team": {"carrier": carriers, "rover": rovers}})
    fleet = compose(team, seed=1, folder=tmp_path).fleet
    aboard = [sum(r.carrier == c.id for r in fleet.robots) for c in fleet.robots[:carriers]]
    assert aboard == [rovers // carriers] * carriers
    assert fleet.type_of(fleet.robots[0]).capacity == max(2, rovers // carriers)
