"""Recordings of 3D maps for the rerun viewer (extra `marsupial[viewer]`)."""

from pathlib import Path

import numpy as np

from simulator.mapping.octree import OctreeMap
from simulator.mapping.pictures import height_colours


class ViewerMissingError(ImportError):
    """The optional viewer library is not installed; the message says how to install it."""


def write_recording(octree: OctreeMap, path: Path) -> None:
    """Writes the occupied leaves of a map as boxes into a `.rrd` file; needs no display.

    Raises:
        ViewerMissingError: rerun is not installed.
    """
    try:
        import rerun
    except ImportError:
        raise ViewerMissingError(
            "recordings need the rerun library: pip install 'marsupial[viewer]'"
        ) from None
    centres, edges, log_odds = octree.leaves()
    occupied = log_odds >= 0
    centres, edges = centres[occupied], edges[occupied]
    recording = rerun.RecordingStream("marsupial-map")
    recording.save(path)
    recording.log("map", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    recording.log(
        "map/occupied",
        rerun.Boxes3D(
            centers=centres,
            half_sizes=np.repeat(edges[:, None] / 2, 3, axis=1),
            colors=height_colours(centres[:, 2]),
            fill_mode="solid",
        ),
        static=True,
    )
    recording.disconnect()
