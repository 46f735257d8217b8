import numpy as np

from simulator.vegetation.baselines import MeanRemissionClassifier, range_difference_features


def test_nearer_mean_wins() -> None:
    remission = np.array([10.0, 20.0, 60.0, 80.0])
    classifier = MeanRemissionClassifier.train(remission, np.array([False, False, True, True]))
    assert (classifier.mean_street, classifier.mean_vegetation) == (15.0, 70.0)
    assert classifier.is_vegetation(np.array([42.0, 43.0])).tolist() == [False, True]


def test_range_differences_by_hand() -> None:
    """Eqs. 6.27 and 6.28 on one line: x = 1, 1.1, 1.4, 1.4."""
    x = np.array([[1.0, 1.1, 1.4, 1.4]])
    found = range_difference_features(x, 2 * x)
    assert np.isnan(found[0, :2, 0]).all()
    assert np.allclose(found[0, 2:, 0], [0.2, 0.3])
    assert np.array_equal(found[..., 1], 2 * x)


def test_a_slope_is_not_rough() -> None:
    x = np.linspace(1, 2, 11)[None]
    assert np.allclose(range_difference_features(x, x)[0, 2:, 0], 0)


def test_gaps_have_no_roughness() -> None:
    x = np.array([[1.0, 1.1, np.nan, 1.3, 1.4, 1.5]])
    rough = range_difference_features(x, x)[0, :, 0]
    assert np.isnan(rough[:5]).all()
    assert np.isfinite(rough[5])
