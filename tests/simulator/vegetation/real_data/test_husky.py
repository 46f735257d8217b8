from pathlib import Path

import numpy as np

from simulator.vegetation.real_data.husky import WHEEL_BASE_M, read_husky


def test_runs_hold_acceleration_first_and_odometry(tmp_path: Path) -> None:
    folder = tmp_path / "CONCRETE"
    folder.mkdir()
    time_s = np.arange(0, 4, 0.02)
    rates, accelerations = np.full((200, 3), 0.1), np.tile([1.0, 2.0, 9.8], (200, 1))
    imu = np.column_stack([time_s, rates, accelerations])
    np.savetxt(folder / "imu_1.csv", imu, delimiter=",", header="time,wx,wy,wz,ax,ay,az")
    wheels = np.column_stack([np.arange(0, 4, 1 / 15), np.full(60, 0.4), np.full(60, 0.6)])
    np.savetxt(folder / "pro_1.csv", wheels, delimiter=",", header="time,velL,velR")
    (run,) = read_husky(tmp_path)
    assert (run.name, run.terrain) == ("CONCRETE/1", "CONCRETE")
    assert np.allclose(run.samples[50], [1.0, 2.0, 9.8, 0.1, 0.1, 0.1])
    assert np.allclose(run.forward_m_s, 0.5)
    assert np.allclose(run.rotation_rad_s, 0.2 / WHEEL_BASE_M)
