import numpy as np
from scipy.spatial import cKDTree

from simulator.vegetation.local_statistics import LEAST_NEIGHBOURS, local_statistics


def scene() -> tuple[np.ndarray, np.ndarray]:
    """Level ground 1 m below the sensor, smooth on one side and rough on the other."""
    random = np.random.default_rng(1)
    ground = random.uniform([2, -2], [5, 2], (1500, 2))
    rough = ground[:, 1] > 0
    height = -1 + np.where(rough, random.normal(0, 0.05, 1500), random.normal(0, 0.002, 1500))
    remission = np.where(rough, 50.0, 10.0) + random.normal(0, 1.0, 1500)
    return np.column_stack([ground, height]), remission


def test_against_one_neighbourhood_at_a_time() -> None:
    points, remission = scene()
    chosen = np.arange(0, 1500, 60)
    found = local_statistics(points, remission, chosen, 0.4, chunk=7)
    tree = cKDTree(points)
    for k, number in enumerate(chosen):
        members = tree.query_ball_point(points[number], 0.4)
        if len(members) < LEAST_NEIGHBOURS:
            members = tree.query(points[number], LEAST_NEIGHBOURS)[1]
        around, values = points[members], remission[members]
        variances, axes = np.linalg.eigh(np.cov(around.T, bias=True))
        normal = axes[:, 0]
        at = points[number]
        expected = [
            np.arccos(abs(at @ normal) / np.linalg.norm(at)),
            np.sqrt(variances[0]),
            np.sqrt(variances[0] / variances.sum()),
            np.abs((around - around.mean(axis=0)) @ normal).max(),
            values.mean(),
            values.std(),
            np.sort(values)[len(values) // 2],
        ]
        assert np.allclose(found[k], expected, atol=1e-6)


def test_rough_ground_shows_at_every_scale() -> None:
    points, remission = scene()
    chosen = np.flatnonzero(np.abs(points[:, 1]) > 1)
    rough = points[chosen, 1] > 0
    for radius_m in (0.2, 0.4, 0.8):
        deviation = local_statistics(points, remission, chosen, radius_m)[:, 1]
        assert deviation[rough].min() > deviation[~rough].max()
