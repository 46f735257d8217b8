from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from simulator.mapping.hierarchy import Segment
from simulator.mapping.point_cloud import read_labels
from simulator.mapping.scene import DepthSensor, tabletop_scene
from simulator.mapping.table_frame import level
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


def overlap(found: Segment, truth: NDArray[np.bool_], tree: cKDTree) -> float:
    """Intersection over union of a segment and an object's labelled points."""
    mine = np.zeros(len(truth), dtype=bool)
    mine[tree.query(found.points_m)[1]] = True
    return float((mine & truth).sum() / (mine | truth).sum())


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
@pytest.mark.parametrize(
    ("name", "structures"),
    [
        # Labels of what stands on the table; a stack is one structure to a geometric method.
        ("test3", [{20}, {30}]),
        ("test12", [{20}, {30}, {40}]),
        ("test16", [{20, 30, 40}]),
        ("test31", [{20, 40}, {30}]),
    ],
)
def test_structures_of_real_kinect_scenes_are_found(name: str, structures: list[set[int]]) -> None:
    points, labels = read_labels(DATA / "pcl" / "mOSD" / f"{name}.pcd")
    pose = level(points)
    upright = (points @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)
    parts = segment(upright, TabletopParameters())
    found = [part for part in parts if part.label == "object"]
    tree = cKDTree(upright)
    assert len(found) == len(structures)
    for structure in structures:
        truth = np.isin(labels, list(structure))
        assert max(overlap(part, truth, tree) for part in found) > 0.96
