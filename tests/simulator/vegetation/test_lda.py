import numpy as np
import pytest
from scipy.stats import norm

from simulator.vegetation.lda import LdaClassifier, train_lda


def two_clouds(seed: int, count: int = 500) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    vegetation = random.random(count) < 0.4
    mixing = np.array([[1.0, 0.8, 0.0], [0.0, 0.5, 0.1], [0.0, 0.0, 2.0]])
    features = random.normal(0, 1, (count, 3)) @ mixing + [3.0, 0.0, 50.0]
    return features + np.where(vegetation[:, None], [0.0, 1.5, 4.0], 0.0), vegetation


def test_projection_maximises_the_criterion() -> None:
    """Eq. 6.24: no other direction separates the means better for its spread."""
    features, vegetation = two_clouds(1)
    projection = train_lda(features, vegetation).projection

    def criterion(w: np.ndarray) -> float:
        v = features @ w
        within = sum(len(part) * part.var() for part in (v[vegetation], v[~vegetation]))
        return float((v[vegetation].mean() - v[~vegetation].mean()) ** 2 / within)

    random = np.random.default_rng(2)
    others = [projection + random.normal(0, 0.05, 3) * np.abs(projection) for _ in range(50)]
    assert all(criterion(projection) >= criterion(w) - 1e-12 for w in others)


def test_posterior_is_bayes_rule_with_two_gaussians() -> None:
    """Eq. 6.26."""
    features, vegetation = two_clouds(3)
    classifier = train_lda(features, vegetation)
    v = features @ classifier.projection
    street, grass = (
        norm(mean, deviation).pdf(v)
        for mean, deviation in zip(classifier.means, classifier.deviations, strict=True)
    )
    assert np.allclose(classifier.vegetation_probability(features), grass / (grass + street))


def test_classifies_new_samples() -> None:
    classifier = train_lda(*two_clouds(4))
    features, vegetation = two_clouds(5)
    found = classifier.vegetation_probability(features) > 0.5
    assert np.mean(found == vegetation) > 0.9


def test_one_class_is_refused() -> None:
    with pytest.raises(ValueError, match="both classes"):
        train_lda(np.random.default_rng(6).normal(size=(10, 3)), np.zeros(10, bool))


def test_arrays_there_and_back() -> None:
    features, vegetation = two_clouds(7)
    classifier = train_lda(features, vegetation)
    again = LdaClassifier.from_arrays(classifier.arrays())
    assert np.array_equal(again.log_odds(features), classifier.log_odds(features))


def test_dependent_features_are_refused() -> None:
    features, vegetation = two_clouds(8)
    with pytest.raises(ValueError, match="linearly dependent"):
        train_lda(np.column_stack([features, np.ones(len(features))]), vegetation)
