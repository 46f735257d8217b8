import importlib.util
from pathlib import Path

import pytest

from simulator.mapping.octree import OctreeMap
from simulator.mapping.recording import ViewerMissingError, write_recording

RERUN = importlib.util.find_spec("rerun") is not None


@pytest.mark.skipif(RERUN, reason="rerun is installed")
def test_without_the_viewer_a_sentence_says_how_to_get_it(tmp_path: Path) -> None:
    with pytest.raises(ViewerMissingError, match=r"pip install 'marsupial\[viewer\]'"):
        write_recording(OctreeMap(0.1), tmp_path / "map.rrd")


@pytest.mark.skipif(not RERUN, reason="rerun (marsupial[viewer]) is not installed")
def test_a_recording_is_written(tmp_path: Path) -> None:
    octree = OctreeMap(0.1)
    octree.set_log_odds([[0.05, 0.05, 0.05]], [3.5])
    write_recording(octree, tmp_path / "map.rrd")
    assert (tmp_path / "map.rrd").read_bytes()[:3] == b"RRF"
