from pathlib import Path

import numpy as np
import pytest

from simulator.vegetation.real_data.labelled_scan import (
    RELLIS_CONCRETE,
    RELLIS_GRASS,
    DataError,
    read_rellis,
    read_semantic_kitti,
)

DATA = Path(__file__).parents[5] / "shared" / "data"


def write(folder: Path, labels: list[int]) -> tuple[Path, Path]:
    cloud = np.array([[3, 4, 0, 0.5], [0, 0, 0, 0], [0, -2, 1, 0.25]], "<f4")
    cloud.tofile(folder / "scan.bin")
    np.array(labels, "<u4").tofile(folder / "scan.label")
    return folder / "scan.bin", folder / "scan.label"


def test_returns_keep_their_labels(tmp_path: Path) -> None:
    scan = read_rellis(*write(tmp_path, [3, 0, 23]))
    assert scan.points_m.tolist() == [[3, 4, 0], [0, -2, 1]]
    assert scan.remission.tolist() == [0.5, 0.25]
    assert scan.label.tolist() == [3, 23]
    assert scan.azimuth_rad()[1] == pytest.approx(-np.pi / 2)


def test_instance_numbers_are_dropped(tmp_path: Path) -> None:
    scan = read_semantic_kitti(*write(tmp_path, [72 + (5 << 16), 0, 40]))
    assert scan.label.tolist() == [72, 40]


def test_files_that_do_not_fit_are_named(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"scan.bin: 12 numbers for 2 labels in scan.label"):
        read_rellis(*write(tmp_path, [3, 23]))


def test_the_published_scan() -> None:
    path = DATA / "rellis" / "000104.bin"
    if not path.is_file():
        pytest.skip(f"RELLIS-3D is not in {DATA}")
    scan = read_rellis(path, path.with_suffix(".label"))
    assert (scan.label == RELLIS_GRASS).sum() == 18_040
    assert (scan.label == RELLIS_CONCRETE).sum() == 20_242
