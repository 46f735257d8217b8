import numpy as np

from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.scanning import driving_scan, scan_lines, tilting_scan
from simulator.vegetation.simulation.terrain_world import TerrainWorld

FIXED = SensorSetup("LMS 291-S05", 0.6, (np.deg2rad(20.0),) * 2)


def meadow(**more: object) -> TerrainWorld:
    lawn = np.full((400, 400), Material.LAWN, np.uint8)
    lawn[:, :200] = Material.ASPHALT
    return TerrainWorld(lawn, 0.05, seed=3, **more)  # type: ignore[arg-type]


def test_the_middle_beam_meets_the_ground_where_geometry_says() -> None:
    world = meadow(undulation_m=0.0)
    sweep = scan_lines(
        world, FIXED, np.array([[8.0, 10.0, 0.0]]), np.deg2rad([20.0]), np.random.default_rng(1)
    )
    middle = np.abs(sweep.points_m[:, 1] - 10.0) < 0.02
    assert np.abs(sweep.points_m[middle, 0] - (8.0 + 0.6 / np.tan(np.deg2rad(20)))).max() < 0.15
    assert np.abs(sweep.range_m()[middle] - 0.6 / np.sin(np.deg2rad(20))).max() < 0.15


def test_points_lie_on_the_undulating_ground() -> None:
    world = meadow()
    sweep = tilting_scan(world, FIXED, (10.0, 10.0, 1.0), np.random.default_rng(2))
    error = sweep.points_m[:, 2] - world.ground_m(sweep.points_m[:, :2])
    assert np.abs(error.mean()) < 0.005
    assert error.std() < 0.03


def test_material_is_what_lies_there() -> None:
    sweep = driving_scan(
        meadow(undulation_m=0.0), FIXED, np.array([[9.0, 10.0, 0.0]]), np.random.default_rng(3)
    )
    clear = np.abs(sweep.points_m[:, 0] - 10.0) > 0.3
    expected = np.where(sweep.points_m[:, 0] > 10.0, Material.LAWN, Material.ASPHALT)
    assert (sweep.material[clear] == expected[clear]).all()


def test_a_wall_and_a_trunk_stand_in_the_way() -> None:
    world = meadow(
        cylinders=np.array([[10.0, 10.5, 0.2, 3.0, Material.BARK]]),
        boxes=np.array([[9.8, 10.2, 8.0, 9.5, 3.0, Material.PLASTER]]),
    )
    tilt = SensorSetup("LMS 291-S05", 0.6, (-0.3, 0.3))
    sweep = tilting_scan(world, tilt, (8.0, 10.0, 0.0), np.random.default_rng(4))
    trunk = sweep.points_m[sweep.material == Material.BARK]
    assert len(trunk) > 50
    assert np.abs(np.linalg.norm(trunk[:, :2] - [10.0, 10.5], axis=1) - 0.2).max() < 0.1
    wall = sweep.points_m[sweep.material == Material.PLASTER]
    assert len(wall) > 50
    outside = wall[:, :2] - np.clip(wall[:, :2], [9.8, 8.0], [10.2, 9.5])
    assert np.linalg.norm(outside, axis=1).max() < 0.1
    assert not sweep.on_ground[np.isin(sweep.material, [Material.BARK, Material.PLASTER])].any()


def test_overgrown_gravel_is_half_grass() -> None:
    gravel = TerrainWorld(np.full((400, 400), Material.GRAVEL, np.uint8), 0.05, seed=1)
    sweep = tilting_scan(gravel, FIXED, (8.0, 10.0, 0.0), np.random.default_rng(5), 0.01)
    share = np.mean(sweep.material == Material.LAWN)
    assert 0.35 < share < 0.65


def test_a_seed_repeats() -> None:
    one, two = (
        tilting_scan(meadow(), FIXED, (8.0, 10.0, 0.0), np.random.default_rng(6)) for _ in range(2)
    )
    assert np.array_equal(one.points_m, two.points_m)
    assert np.array_equal(one.remission, two.remission)
