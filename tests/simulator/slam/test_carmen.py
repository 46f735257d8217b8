import math
from pathlib import Path

import numpy as np
import pytest

from simulator.slam.carmen import CarmenLogError, read_carmen, write_carmen
from simulator.slam.range_scan import RangeScan

DATA = Path(__file__).parents[4] / "shared" / "data"


def some_scans(beams: int, first: float, step: float) -> list[RangeScan]:
    random = np.random.default_rng(beams)
    return [
        RangeScan(
            100.0 + time,
            random.uniform(0.5, 9.0, beams).astype(np.float32),
            first,
            step,
            30.0,
            random.normal(size=3),
        )
        for time in range(3)
    ]


@pytest.mark.parametrize("name", ["log.clf", "log.clf.gz"])
@pytest.mark.parametrize(
    ("beams", "first", "step"),
    [
        (180, -math.pi / 2, math.pi / 180),
        (361, -math.pi / 2, math.pi / 360),
        (72, 0.0, math.tau / 72),
    ],
)
def test_what_was_written_reads_back(
    tmp_path: Path, name: str, beams: int, first: float, step: float
) -> None:
    scans = some_scans(beams, first, step)
    write_carmen(scans, tmp_path / name)
    again = read_carmen(tmp_path / name, range_m=30.0)
    for one, other in zip(scans, again, strict=True):
        assert np.array_equal(one.ranges_m, other.ranges_m)
        assert np.array_equal(one.odometry, other.odometry)
        assert one.time_s == other.time_s
        assert np.allclose(one.bearings_rad(), other.bearings_rad())


def test_corrected_poses_replace_the_odometry(tmp_path: Path) -> None:
    scans = some_scans(180, -math.pi / 2, math.pi / 180)
    poses = np.arange(9.0).reshape(3, 3)
    write_carmen(scans, tmp_path / "log", poses)
    assert np.array_equal([s.odometry for s in read_carmen(tmp_path / "log")], poses)


def test_a_line_that_is_cut_off_is_named(tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.write_text("PARAM robot_width 0.5\nFLASER 4 1.0 2.0\n")
    with pytest.raises(CarmenLogError, match="log:2: FLASER message is malformed"):
        read_carmen(path)
    path.write_text("ODOM 0 0 0\n")
    with pytest.raises(CarmenLogError, match="is it a CARMEN log"):
        read_carmen(path)


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
@pytest.mark.parametrize(
    ("name", "count", "beams"),
    [
        ("carmen_raw/fr079.clf.bz2", 4934, 360),
        ("carmen_raw/fr-clinic_robotlaser.clf.bz2", 6917, 181),
        ("carmen/freiburg-101-corrected.log.gz", 292, 360),
    ],
)
def test_public_logs_are_read(name: str, count: int, beams: int) -> None:
    scans = read_carmen(DATA / name)
    assert len(scans) == count
    assert len(scans[0].ranges_m) == beams
    view = math.degrees(float(np.ptp(scans[0].bearings_rad())))
    assert view == pytest.approx(180.0, abs=1.1)
