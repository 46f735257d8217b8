import numpy as np

from simulator.slam.range_scan import RangeScan


def test_points_are_where_beams_ended() -> None:
    ranges = np.array([1.0, 2.0, 8.0, 0.0], dtype=np.float32)
    scan = RangeScan(0.0, ranges, 0.0, np.pi / 2, 8.0, np.zeros(3))
    assert scan.hits().tolist() == [True, True, False, False]
    assert np.allclose(scan.points(), [[1.0, 0.0], [0.0, 2.0]])


def test_thinning_keeps_one_point_a_square() -> None:
    ranges = np.full(720, 5.0, dtype=np.float32)
    scan = RangeScan(0.0, ranges, 0.0, np.pi / 360, 8.0, np.zeros(3))
    thin = scan.points(0.5)
    assert len({tuple(cell) for cell in np.floor(thin / 0.5).astype(int).tolist()}) == len(thin)
    assert 40 < len(thin) < 100
