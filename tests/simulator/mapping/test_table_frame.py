import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simulator.mapping.scene import DepthSensor, tabletop_scene
from simulator.mapping.table_frame import level


def test_a_tilted_camera_is_stood_upright_over_its_table() -> None:
    sensor = DepthSensor(columns=120, rows=90, horizontal_field_rad=0.6, vertical_field_rad=0.45)
    origin_m = np.array([-1.1, 0.1, 1.3])
    measured = sensor.measure(tabletop_scene(objects=2, seed=4), origin_m, 0.0, 0.5)
    turn = Rotation.from_euler("xyz", [0.4, -0.9, 2.0]).as_matrix()
    in_camera = ((measured - origin_m) @ turn).astype(np.float32)
    pose = level(in_camera, table_height_m=0.75)
    upright = in_camera @ pose[:3, :3].T + pose[:3, 3]
    assert upright[:, 2] == pytest.approx(measured[:, 2], abs=2e-3)
    assert pose[2, 3] == pytest.approx(1.3, abs=2e-3)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)


def test_points_without_a_plane_are_no_table() -> None:
    cloud = np.random.default_rng(0).uniform(-5, 5, (2000, 3)).astype(np.float32)
    with pytest.raises(ValueError, match="no view of a table"):
        level(cloud)
