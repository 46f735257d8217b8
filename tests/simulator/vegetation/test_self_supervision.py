import numpy as np
import pytest

from simulator.vegetation.scores import Scores
from simulator.vegetation.self_supervision import (
    RecordedDrive,
    RecordedScan,
    SelfSupervisionParameters,
    label_scans,
    learn_from_drive,
)
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.recording import (
    self_supervised_drive,
    vibration_classifier,
)
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.worlds import street_and_lawn
from simulator.vegetation.svm import SvmParameters
from simulator.vegetation.vibration import VibrationRun

QUICK = SvmParameters(log2_gamma=(-3, -1), log2_c=(1, 5), search_points=600)
SETUP = SensorSetup("LMS 291-S05", 0.55, (float(np.deg2rad(6)), float(np.deg2rad(30))))


class FeelsGrassWhenShaken:
    def vegetation_probability(self, features: np.ndarray) -> np.ndarray:
        return (features[:, 1:32].sum(axis=1) > 100.0).astype(float)


def straight_drive(scan_time_s: float) -> RecordedDrive:
    """20 m along the x axis at 1 m/s, shaken beyond 10 m, with a scan of the ground below."""
    count = 2000
    x = np.arange(count) / 100.0
    random = np.random.default_rng(1)
    shaking = random.normal(size=count) * np.where(x > 10, 3.0, 0.01)
    vibration = VibrationRun(100.0, shaking, np.ones(count), np.zeros(count))
    poses = np.column_stack([x, np.zeros((count, 2))])
    along, across = np.meshgrid(np.arange(0.05, 20, 0.1), np.arange(-1.95, 2, 0.1))
    points = np.column_stack([along.ravel(), across.ravel(), np.zeros(along.size)])
    sensor = points + np.array([-1.0, 0.0, 0.5])
    scan = RecordedScan(scan_time_s, points, np.full(len(points), 7.0), sensor)
    return RecordedDrive(x, poses, vibration, [scan])


def test_labels_lie_where_the_robot_drove_and_not_at_the_border() -> None:
    drive = straight_drive(-1.0)
    labelled = label_scans(drive, FeelsGrassWhenShaken())
    at = drive.scans[0].points_m[labelled.index]
    assert np.abs(at[:, 1]).max() < 0.36
    assert (labelled.vegetation == (at[:, 0] > 10)).all()
    assert labelled.vegetation.sum() > 300
    assert (~labelled.vegetation).sum() > 300


def test_scans_after_the_pass_get_no_label() -> None:
    assert len(label_scans(straight_drive(100.0), FeelsGrassWhenShaken()).index) == 0
    half = label_scans(straight_drive(15.0), FeelsGrassWhenShaken())
    assert half.vegetation.all()


def test_a_drive_over_one_kind_of_ground_is_refused() -> None:
    with pytest.raises(ValueError, match="felt like pavement"):
        learn_from_drive(straight_drive(15.0), FeelsGrassWhenShaken(), SETUP)
    with pytest.raises(ValueError, match="felt like grass"):
        learn_from_drive(straight_drive(100.0), FeelsGrassWhenShaken(), SETUP)


def test_the_whole_loop_learns_to_see_grass_in_another_place() -> None:
    """Vibration classifier, training place and test place are all drawn by different seeds."""
    terrain = vibration_classifier(301, 20.0, SvmParameters((-7,), (3,)))
    drive, _ = self_supervised_drive(street_and_lawn(1, (24.0, 16.0)), 1, 2, 5.0, SETUP)
    parameters = SelfSupervisionParameters(svm=QUICK)
    model, _ = learn_from_drive(drive, terrain, SETUP, parameters)
    test, sweeps = self_supervised_drive(street_and_lawn(2, (24.0, 16.0)), 2, 2, 5.0, SETUP)
    labelled = label_scans(test, terrain)
    truth = np.concatenate(
        [
            sweep.material[labelled.index[labelled.scan == number]] == Material.LAWN
            for number, sweep in enumerate(sweeps)
        ]
    )
    found = model.vegetation_probability(labelled.measurements, SETUP) > 0.5
    scores = Scores.of(found, truth)
    assert scores.precision > 0.99
    assert scores.recall > 0.99
    assert np.mean(labelled.vegetation == truth) > 0.99
