import numpy as np

from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.worlds import CampusParameters, campus, street_and_lawn


def test_street_and_lawn_hold_both_and_tiles() -> None:
    world = street_and_lawn(1)
    shares = [np.mean(world.material == kind) for kind in (Material.ASPHALT, Material.LAWN)]
    assert min(shares) > 0.2
    assert (world.material == Material.LIGHT_TILES).any()
    assert not np.array_equal(world.material, street_and_lawn(2).material)


def test_every_path_of_a_campus_is_paved_and_toured() -> None:
    drawn = campus(4, CampusParameters((80.0, 60.0)))
    for _, _, line in drawn.paths:
        assert np.isin(
            drawn.world.material_at(line), [Material.ASPHALT, Material.LIGHT_TILES]
        ).all()
    tour = drawn.tour()
    for node in drawn.nodes_m:
        assert np.linalg.norm(tour - node, axis=1).min() < 0.2
    assert np.linalg.norm(np.diff(tour, axis=0), axis=1).max() < 1.0


def test_nothing_stands_on_a_path() -> None:
    drawn = campus(5, CampusParameters((80.0, 60.0)))
    lines = np.concatenate([line for _, _, line in drawn.paths])
    for x, y, radius, *_ in drawn.world.cylinders:
        assert np.linalg.norm(lines - [x, y], axis=1).min() > radius + 1.5
    for low_x, high_x, low_y, high_y, *_ in drawn.world.boxes:
        nearest = np.clip(lines, [low_x, low_y], [high_x, high_y])
        assert np.linalg.norm(nearest - lines, axis=1).min() > 1.5


def test_a_seed_repeats() -> None:
    one, two = campus(6), campus(6)
    assert np.array_equal(one.world.material, two.world.material)
    assert np.array_equal(one.world.boxes, two.world.boxes)
