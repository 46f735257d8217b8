import struct
from pathlib import Path

import numpy as np
import pypcd4
import pytest
import trimesh

from simulator.mapping.point_cloud import (
    PointCloudError,
    read_labels,
    read_points,
    read_scan_log,
)

DATA = Path(__file__).parents[3] / ".." / "shared" / "data"
POINTS = np.array([[1.0, 2.0, 3.0], [-1.5, 0.25, 0.0], [np.nan, 0.0, 0.0]], dtype=np.float32)


@pytest.mark.parametrize("encoding", list(pypcd4.Encoding))
def test_every_encoding_of_pcd_reads_the_same(encoding: pypcd4.Encoding, tmp_path: Path) -> None:
    path = tmp_path / "cloud.pcd"
    pypcd4.PointCloud.from_xyz_points(POINTS).save(path, encoding=encoding)
    assert np.array_equal(read_points(path), POINTS[:2])


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_ply_and_text_read_the_same(encoding: str, tmp_path: Path) -> None:
    cloud = trimesh.PointCloud(POINTS[:2])
    (tmp_path / "cloud.ply").write_bytes(cloud.export(file_type="ply", encoding=encoding))
    assert np.allclose(read_points(tmp_path / "cloud.ply"), POINTS[:2])
    np.savetxt(tmp_path / "cloud.xyz", POINTS[:2])
    assert np.allclose(read_points(tmp_path / "cloud.xyz"), POINTS[:2])


def test_labels_come_with_their_points(tmp_path: Path) -> None:
    cloud = pypcd4.PointCloud.from_points(
        [*POINTS.T, np.array([7, 8, 9])], ("x", "y", "z", "label"), (np.float32,) * 3 + (np.uint32,)
    )
    cloud.save(tmp_path / "labelled.pcd")
    points, labels = read_labels(tmp_path / "labelled.pcd")
    assert np.array_equal(points, POINTS[:2])
    assert labels.tolist() == [7, 8]


def test_a_text_log_turns_scans_into_the_map_frame(tmp_path: Path) -> None:
    lines = ["# comment", f"NODE 1 0 0 0 0 {np.pi / 2}", "2 0 0", "NODE 0 0 5 0 0 0"]
    (tmp_path / "two.log").write_text("\n".join(lines))
    first, second = read_scan_log(tmp_path / "two.log")
    assert first.in_map_frame() == pytest.approx(np.array([[1.0, 2.0, 0.0]]), abs=1e-6)
    assert second.points_m.shape == (0, 3)
    (tmp_path / "bad.log").write_text("NODE 0 0 0 0 0 0\n1 2 x\n")
    with pytest.raises(PointCloudError, match=r"bad.log:2: expected"):
        read_scan_log(tmp_path / "bad.log")


def test_a_graph_reads_poses_and_points(tmp_path: Path) -> None:
    point = struct.pack("<I3d", 3, 1.0, 2.0, 3.0)
    pose = struct.pack("<I3dI4d", 3, 10.0, 0.0, 0.0, 4, 1.0, 0.0, 0.0, 0.0)
    content = struct.pack("<II", 1, 1) + point + pose + struct.pack("<II", 0, 0)
    (tmp_path / "one.graph").write_bytes(content)
    (scan,) = read_scan_log(tmp_path / "one.graph")
    assert scan.in_map_frame().tolist() == [[11.0, 2.0, 3.0]]
    (tmp_path / "cut.graph").write_bytes(content[:40])
    with pytest.raises(PointCloudError, match="ends at byte 40"):
        read_scan_log(tmp_path / "cut.graph")


def test_files_that_are_no_clouds_are_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(PointCloudError, match=r"not \.jpg"):
        read_points(tmp_path / "photo.jpg")
    (tmp_path / "broken.pcd").write_text("no header\n")
    with pytest.raises(PointCloudError, match=r"broken\.pcd"):
        read_points(tmp_path / "broken.pcd")


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
def test_real_files_are_read() -> None:
    assert read_points(DATA / "pcl" / "room_scan1.pcd").shape == (112586, 3)
    points, labels = read_labels(DATA / "pcl" / "mOSD" / "test3.pcd")
    assert len(points) == len(labels) > 100_000
    (scan,) = read_scan_log(DATA / "octomap" / "spherical_scan.graph")
    assert scan.points_m.shape == (10201, 3)
