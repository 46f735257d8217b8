from pathlib import Path

import numpy as np
import pytest

from simulator.mapping.point_cloud import read_labels
from simulator.mapping.scene import DepthSensor, tabletop_scene
from simulator.mapping.tabletop import TabletopParameters, clusters, segment, tabletop_hierarchy

DATA = Path(__file__).parents[3] / ".." / "shared" / "data"
SENSOR = DepthSensor(columns=320, rows=240, horizontal_field_rad=0.9, vertical_field_rad=0.7)
VIEWS = [((-1.5, 0.0, 1.4), 0.0), ((1.5, 0.3, 1.4), np.pi), ((0.0, -1.4, 1.4), np.pi / 2)]


def test_clusters_are_joined_by_short_distances() -> None:
    points = np.array([[0, 0, 0], [0.009, 0, 0], [0.018, 0, 0], [1, 0, 0]], dtype=np.float32)
    assert [part.tolist() for part in clusters(points, 0.01)] == [[0, 1, 2], [3]]
    assert clusters(points[:0], 0.01) == []


def test_a_scene_is_cut_into_background_table_and_objects() -> None:
    points = SENSOR.measure(tabletop_scene(objects=4, seed=1), *VIEWS[0], pitch_rad=0.45)
    parts = segment(points, TabletopParameters(cluster_distance_m=0.02))
    assert [part.label for part in parts] == ["background", "table", *["object"] * 4]
    assert sum(len(part.points_m) for part in parts) == len(points)
    table = next(part for part in parts if part.label == "table")
    assert table.points_m[:, 2] == pytest.approx(0.75, abs=0.02)
    for part in parts[2:]:
        assert (part.points_m[:, 2] > 0.75).all()
        assert np.ptp(part.points_m[:, :2], axis=0).max() < 0.2


def test_several_views_fill_one_hierarchy() -> None:
    scene = tabletop_scene(objects=4, seed=1)
    hierarchy = tabletop_hierarchy({"background": 0.05, "table": 0.01, "object": 0.004})
    for origin, yaw in VIEWS:
        points = SENSOR.measure(scene, origin, yaw, pitch_rad=0.45)
        hierarchy.update(
            segment(points, TabletopParameters(cluster_distance_m=0.02)), np.array(origin)
        )
    labels = [node.label for node in hierarchy.nodes()]
    assert labels.count("background") == 1
    assert labels.count("table") == 1
    assert labels.count("object") == 4
    table = next(node for node in hierarchy.nodes() if node.label == "table")
    assert len(table.children) == 4
    assert all(node.existence > 0.7 for node in hierarchy.nodes())


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
def test_objects_of_a_real_scene_are_found() -> None:
    points, labels = read_labels(DATA / "pcl" / "mOSD" / "test3.pcd")
    assert len(np.unique(labels)) > 1
    assert len(points) == len(labels)
