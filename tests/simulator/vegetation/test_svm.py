import numpy as np
import pytest
from sklearn.svm import SVC

from simulator.vegetation.svm import SvmClassifier, SvmParameters, train_svm

SMALL = SvmParameters(log2_gamma=(-3, -1, 1), log2_c=(-1, 3), search_points=300)


def rings(seed: int, count: int = 300) -> tuple[np.ndarray, np.ndarray]:
    """A disc inside a ring: no line separates them."""
    random = np.random.default_rng(seed)
    inner = random.random(count) < 0.5
    radius = np.where(inner, random.uniform(0, 1, count), random.uniform(1.3, 2.5, count))
    angle = random.uniform(0, 2 * np.pi, count)
    return np.column_stack([100 + 20 * radius * np.cos(angle), radius * np.sin(angle)]), inner


def test_separates_what_no_line_does() -> None:
    classifier = train_svm(*rings(1), parameters=SMALL)
    features, inner = rings(2)
    accuracy = np.mean((classifier.vegetation_probability(features) > 0.5) == inner)
    assert accuracy > 0.97


def test_decision_is_that_of_libsvm() -> None:
    features, inner = rings(3)
    parameters = SvmParameters(log2_gamma=(-1,), log2_c=(3,))
    classifier = train_svm(features, inner, parameters=parameters)
    standard = (features - features.mean(axis=0)) / features.std(axis=0)
    machine = SVC(C=8.0, gamma=0.5).fit(standard, inner)
    assert (classifier.gamma, classifier.c) == (0.5, 8.0)
    assert np.allclose(
        classifier.decision(features), machine.decision_function(standard), atol=1e-3
    )


def test_probabilities_are_calibrated() -> None:
    """Overlapping classes with a known posterior: Platt's sigmoid comes close to it."""
    random = np.random.default_rng(4)
    vegetation = random.random(2000) < 0.5
    x = random.normal(np.where(vegetation, 1.0, -1.0), 1.5)
    classifier = train_svm(x[:, None], vegetation, parameters=SMALL)
    at = np.linspace(-3, 3, 13)
    posterior = 1 / (1 + np.exp(-2 * at / 1.5**2))
    found = classifier.vegetation_probability(at[:, None])
    assert np.abs(found - posterior).max() < 0.12


def test_training_repeats_to_the_bit() -> None:
    features, inner = rings(5)
    one, two = (train_svm(features, inner, parameters=SMALL) for _ in range(2))
    assert np.array_equal(one.weights, two.weights)
    assert one.platt == two.platt


def test_groups_stay_together_in_cross_validation() -> None:
    """A feature that only tells the groups apart must not look useful."""
    random = np.random.default_rng(6)
    group = np.repeat(np.arange(10), 40)
    vegetation = random.random(10)[group] < 0.5
    features = np.column_stack([group + random.normal(0, 0.05, 400), random.normal(0, 1, 400)])
    sharp = SvmParameters(log2_gamma=(3,), log2_c=(5,))
    shuffled = train_svm(features, vegetation, parameters=sharp)
    grouped = train_svm(features, vegetation, group, sharp)
    certainty = [
        np.abs(classifier.vegetation_probability(features) - 0.5).mean()
        for classifier in (shuffled, grouped)
    ]
    assert certainty[0] > 0.4
    assert certainty[1] < certainty[0] - 0.1


def test_one_class_is_refused() -> None:
    with pytest.raises(ValueError, match="both classes"):
        train_svm(np.zeros((10, 2)), np.ones(10, bool))


def test_one_group_is_refused() -> None:
    features, inner = rings(7, 50)
    with pytest.raises(ValueError, match="two groups"):
        train_svm(features, inner, np.zeros(50, int), SMALL)


def test_arrays_there_and_back() -> None:
    features, inner = rings(8)
    classifier = train_svm(features, inner, parameters=SMALL)
    again = SvmClassifier.from_arrays(classifier.arrays())
    assert np.array_equal(
        again.vegetation_probability(features), classifier.vegetation_probability(features)
    )
