import numpy as np

from simulator.slam.odometry import OdometryModel
from simulator.slam.pose import between


def test_samples_spread_as_the_model_says() -> None:
    model, motion = OdometryModel(), np.array([1.0, 0.0, 0.4])
    samples = model.sample(motion, 20_000, np.random.default_rng(0))
    spread = between(motion, samples).std(axis=0)
    assert np.allclose(spread, model.deviations(motion), rtol=0.05)
    assert np.allclose(model.information(motion), np.diag(1.0 / model.deviations(motion) ** 2))


def test_longer_motions_are_less_certain() -> None:
    model = OdometryModel()
    short, long = (model.deviations(np.array([d, 0.0, 0.1])) for d in (0.1, 2.0))
    assert np.all(long > short)
