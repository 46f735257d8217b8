import pickle
from pathlib import Path

import numpy as np
import pytest

from simulator.vegetation.classifier import RemissionModel, WrongSetupError
from simulator.vegetation.features import Measurements
from simulator.vegetation.lda import train_lda
from simulator.vegetation.model_file import ModelFileError, read_model, write_model
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.svm import SvmParameters, train_svm

SETUP = SensorSetup("LMS 291-S05", 0.55, (-0.87, 0.52))


def samples() -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(1)
    vegetation = random.random(200) < 0.5
    features = random.normal([3.0, 1.2, 60.0], [1.0, 0.1, 10.0], (200, 3))
    features[vegetation, 2] += 50.0
    return features, vegetation


@pytest.mark.parametrize("kind", ["svm", "lda"])
def test_a_model_survives_its_file(kind: str, tmp_path: Path) -> None:
    features, vegetation = samples()
    classifier = (
        train_svm(features, vegetation, parameters=SvmParameters((-3,), (1,)))
        if kind == "svm"
        else train_lda(features, vegetation)
    )
    path = tmp_path / "models" / f"{kind}.npz"
    write_model(path, RemissionModel(classifier, SETUP, 4.5))
    model = read_model(path, SETUP)
    measured = Measurements(*features.T)
    before = RemissionModel(classifier, SETUP, 4.5).vegetation_probability(measured, SETUP)
    assert np.array_equal(model.vegetation_probability(measured, SETUP), before, equal_nan=True)
    assert model.setup == SETUP


def test_another_set_up_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    write_model(path, RemissionModel(train_lda(*samples()), SETUP))
    other = SensorSetup("LMS 151", 0.55, SETUP.tilt_rad)
    with pytest.raises(WrongSetupError, match=r"model.npz: the scanner is 'LMS 151'"):
        read_model(path, other)


def test_pickles_are_not_opened(tmp_path: Path) -> None:
    """A file that would run code when unpickled is refused, and the code does not run."""
    ran = tmp_path / "ran"

    class Trap:
        def __reduce__(self) -> tuple[object, tuple[str]]:
            return Path(ran).write_text, ("code ran",)

    loose = tmp_path / "loose.npz"
    loose.write_bytes(pickle.dumps(Trap()))
    inside = tmp_path / "inside.npz"
    np.savez(inside, header=np.array([Trap()], dtype=object))
    for path in (loose, inside):
        with pytest.raises(ModelFileError, match=f"{path.name}: is no model file"):
            read_model(path)
    assert not ran.exists()


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 torn", b"not an archive"])
def test_damaged_files_are_named(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    path.write_bytes(content)
    with pytest.raises(ModelFileError, match=r"model.npz: is no model file"):
        read_model(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelFileError, match="no such file"):
        read_model(tmp_path / "absent.npz")


def test_arrays_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    write_model(path, RemissionModel(train_lda(*samples()), SETUP))
    with np.load(path) as file:
        arrays = dict(file)
    for name, wrong in (("projection", np.ones(7)), ("gaussians", np.full(4, np.nan))):
        np.savez(path, **{**arrays, name: wrong})
        with pytest.raises(ModelFileError, match="train it again"):
            read_model(path)
