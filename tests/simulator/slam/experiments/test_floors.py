import numpy as np

from simulator.slam.experiments.floors import corridor_floor, office_floor


def test_floors_of_a_building_share_walls_and_differ_in_doors() -> None:
    one, other = (office_floor(3, floor, rooms=3)[0].walls() for floor in (0, 1))
    assert one.shape == other.shape
    assert 0.001 < (one != other).mean() < 0.05


def test_the_bare_corridor_has_the_same_ends() -> None:
    doors, bare = (corridor_floor(featureless)[0].walls() for featureless in (False, True))
    assert np.array_equal(doors[:, :100], bare[:, :100])
    assert np.array_equal(doors[:, -100:], bare[:, -100:])
    assert not np.array_equal(doors, bare)
