"""`marsupial vegetation` from samples to a model, and from a scan to its classes."""

import csv
from pathlib import Path

import numpy as np
import pytest

from scenarios.cli import main
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.recording import standing_recording
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.scanning import tilting_scan
from simulator.vegetation.simulation.worlds import street_and_lawn

SETUP = SensorSetup("LMS 151", 0.6, (float(np.deg2rad(15)), float(np.deg2rad(40))))
MOUNTING = ("--scanner", "LMS 151", "--height", "0.6", "--tilt", "15", "40")


def marsupial(*words: object) -> int:
    with pytest.raises(SystemExit) as end:
        main(["vegetation", *(str(word) for word in words)])
    return int(end.value.code or 0)


def write_csv(path: Path, heads: list[str], rows: np.ndarray) -> Path:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(heads)
        writer.writerows(rows.tolist())
    return path


@pytest.fixture
def samples(tmp_path: Path) -> Path:
    measured, vegetation, groups = standing_recording(SETUP, (1, 2), lines=20)
    table = np.column_stack([measured.features(), vegetation, groups])[::6]
    heads = ["range_m", "incidence_rad", "remission", "vegetation", "group"]
    return write_csv(tmp_path / "samples.csv", heads, table)


@pytest.fixture
def scan(tmp_path: Path) -> tuple[Path, np.ndarray]:
    """A scan across the border of street and lawn in the scanner's frame, and where it hit lawn."""
    world = street_and_lawn(9)
    sweep = tilting_scan(world, SETUP, (10.0, 12.0, 0.4), np.random.default_rng(9), 0.02)
    table = np.column_stack([sweep.points_m - sweep.sensor_m, sweep.remission])
    path = write_csv(tmp_path / "scan.csv", ["x_m", "y_m", "z_m", "remission"], table)
    return path, sweep.material == Material.LAWN


@pytest.mark.parametrize("kind", ["svm", "lda"])
def test_trained_on_samples_it_classifies_a_scan(
    kind: str, samples: Path, scan: tuple[Path, np.ndarray], tmp_path: Path
) -> None:
    model, out = tmp_path / "model.npz", tmp_path / "classes.csv"
    words = ("train", model, "--samples", samples, "--classifier", kind, "--quick", *MOUNTING)
    assert marsupial(*words) == 0
    path, lawn = scan
    assert marsupial("classify", model, path, "--out", out, *MOUNTING) == 0
    with out.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    near = np.array([row["vegetation"] != "" for row in rows])
    found = np.array([float(row["vegetation"] or 0) >= 0.5 for row in rows])
    assert np.mean(found[near] == lawn[near]) > 0.95


def test_a_model_is_refused_for_another_mounting(
    samples: Path,
    scan: tuple[Path, np.ndarray],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    model, out = tmp_path / "model.npz", tmp_path / "classes.csv"
    marsupial("train", model, "--samples", samples, "--classifier", "lda", *MOUNTING)
    words = ("classify", model, scan[0], "--out", out, *MOUNTING[:2], "--height", 1.1, "--tilt")
    assert marsupial(*words, 15, 40) != 0
    assert "mounted 1.10 m high, in training it was 0.60 m" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("range_m,remission\n1,2\n", "the column incidence_rad is missing"),
        ("range_m,incidence_rad,remission,vegetation\n1,2,x,1\n", "line 2: is no row"),
        ("range_m,incidence_rad,remission,vegetation\n1,2,3,7\n", "must hold 0 or 1"),
        ("range_m,incidence_rad,remission,vegetation\n1,1,3,1\n2,1,3,1\n", "both classes"),
        ("range_m,incidence_rad,remission,vegetation\n", "holds no rows"),
    ],
)
def test_bad_samples_are_named(
    text: str, why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    assert marsupial("train", tmp_path / "m.npz", "--samples", path) != 0
    message = capsys.readouterr().err
    assert why in message
    assert "bad.csv" in message


def test_what_cannot_be_simulated_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert marsupial("train", tmp_path / "m.npz", "--scanner", "HDL-64") != 0
    assert "only LMS 291-S05, LMS 151, UTM-30LX can be simulated" in capsys.readouterr().err
    assert marsupial("experiments", "table_9_9") != 0
    assert "choose of table_6_1" in capsys.readouterr().err
