from pathlib import Path

import numpy as np

from simulator.vegetation.real_data.wheelchair import RATE_HZ, read_wheelchair


def test_runs_are_read_and_resampled(tmp_path: Path) -> None:
    time_s = np.arange(0, 2, 0.00412)
    rows = np.column_stack([np.sin(time_s), np.tile(np.arange(5.0), (len(time_s), 1)), time_s])
    for name in ("Middle_GrassPowerStraight2", "Middle_AsphaltStraight"):
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header="a,b,c,d,e,f,time")
    (tmp_path / "Middle_notes.csv").write_text("nothing")
    asphalt, grass = read_wheelchair(tmp_path)
    assert (asphalt.terrain, asphalt.powered) == ("Asphalt", False)
    assert (grass.terrain, grass.powered, grass.name) == ("Grass", True, "GrassPowerStraight2")
    assert grass.samples.shape[1] == 6
    assert abs(len(grass.samples) - 2 * RATE_HZ) <= 2
    assert np.allclose(
        grass.samples[:, 0], np.sin(np.arange(len(grass.samples)) / RATE_HZ), atol=1e-4
    )
