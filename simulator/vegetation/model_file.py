"""Trained models as files: arrays and a JSON header in NumPy's npz, no pickle.

A file names the kind of classifier, its features, and the set-up that it was trained in.
"""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.classifier import RemissionModel, WrongSetupError
from simulator.vegetation.features import REMISSION_FEATURES
from simulator.vegetation.lda import LdaClassifier
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.svm import SvmClassifier

FORMAT = "marsupial vegetation model"
VERSION = 1
KINDS: dict[str, type[SvmClassifier] | type[LdaClassifier]] = {
    SvmClassifier.KIND: SvmClassifier,
    LdaClassifier.KIND: LdaClassifier,
}


class ModelFileError(ValueError):
    """A file that holds no usable model: which file, why, and how to mend it."""


def write_model(path: Path, model: RemissionModel) -> None:
    """Writes a model of one of `KINDS`."""
    classifier = model.classifier
    if not isinstance(classifier, SvmClassifier | LdaClassifier):
        raise TypeError(f"models of type {type(classifier).__name__} cannot be written")
    header = {
        "format": FORMAT,
        "version": VERSION,
        "kind": classifier.KIND,
        "features": list(REMISSION_FEATURES),
        "setup": asdict(model.setup),
        "max_range_m": model.max_range_m,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        arrays: dict[str, Any] = {**classifier.arrays(), "header": np.array(json.dumps(header))}
        np.savez(file, **arrays)


def read_model(path: Path, setup: SensorSetup | None = None) -> RemissionModel:
    """Reads a model; with `setup`, only one that was trained in it.

    Raises:
        ModelFileError: the file is missing, damaged or of another kind.
        WrongSetupError: the model was trained with another scanner or mounting.
    """
    header, arrays = _contents(path)
    try:
        kind = KINDS[header["kind"]]
        trained = header["setup"]
        low, high = trained["tilt_rad"]
        trained_setup = SensorSetup(trained["scanner"], float(trained["height_m"]), (low, high))
        if tuple(header["features"]) != REMISSION_FEATURES:
            raise ModelFileError(
                f"{path}: its features are {', '.join(header['features'])}; "
                f"this version computes {', '.join(REMISSION_FEATURES)}: train it again"
            )
        model = RemissionModel(
            kind.from_arrays(arrays), trained_setup, float(header["max_range_m"])
        )
        # A wrong array shape shows now, not in the middle of a drive.
        model.classifier.vegetation_probability(np.ones((1, len(REMISSION_FEATURES))))
    except ModelFileError:
        raise
    except (KeyError, TypeError, ValueError) as fault:
        raise ModelFileError(f"{path}: {fault!r} in the model; train it again") from None
    mismatch = None if setup is None else setup.mismatch(trained_setup)
    if mismatch is not None:
        raise WrongSetupError(f"{path}: {mismatch}: train a model for this set-up")
    return model


def _contents(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]:
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        header = json.loads(str(arrays.pop("header")))
    except FileNotFoundError:
        raise ModelFileError(f"{path}: no such file; check the path") from None
    except (OSError, KeyError, ValueError, TypeError, EOFError, zipfile.BadZipFile) as fault:
        raise ModelFileError(
            f"{path}: is no model file ({fault}); write one with `marsupial vegetation train`"
        ) from None
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise ModelFileError(f"{path}: is no vegetation model; train one")
    if header.get("version") != VERSION:
        raise ModelFileError(
            f"{path}: has version {header.get('version')}, not {VERSION}: train it again"
        )
    floats = {name: np.asarray(array, dtype=np.float64) for name, array in arrays.items()}
    if not all(np.isfinite(array).all() for array in floats.values()):
        raise ModelFileError(f"{path}: holds numbers that are not finite; train it again")
    return header, floats
