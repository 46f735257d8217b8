"""Real tabletop clouds: objects found, against the labels that people gave them."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from scenarios.benchmarks.mapping.figures import table
from scenarios.benchmarks.mapping.worlds import DATA
from simulator.mapping.octree import OctreeMap
from simulator.mapping.pictures import View, isometric_picture
from simulator.mapping.point_cloud import read_labels
from simulator.mapping.table_frame import level
from simulator.mapping.tabletop import TabletopParameters, segment, tabletop_hierarchy

LABEL_OF_THE_REST = 1


def measure(quick: bool, out: Path) -> str:
    """Intersection over union of each labelled object with its best segment, a hierarchy of each
    cloud against one map at 2 mm."""
    paths = sorted((DATA / "pcl" / "mOSD").glob("*.pcd"))
    if not paths:
        return "The labelled clouds are not here."
    rows = [
        [
            "cloud",
            "objects",
            "segments",
            "IoU of each object",
            "object points: precision, recall",
            "segmentation [CPU s]",
            "one map at 2 mm / hierarchy",
        ]
    ]
    for path in paths[: 1 if quick else None]:
        points, labels = read_labels(path)
        pose = level(points)
        upright = (points @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)
        begin_s = time.process_time()
        parts = segment(upright, TabletopParameters())
        spent_s = time.process_time() - begin_s
        tree = cKDTree(upright)
        found = np.zeros(len(upright), dtype=np.int64)
        objects = [part for part in parts if part.label == "object"]
        for number, part in enumerate(objects, start=1):
            found[tree.query(part.points_m)[1]] = number
        overlaps = []
        for label in np.unique(labels[labels != LABEL_OF_THE_REST]):
            truth = labels == label
            overlaps.append(
                max(
                    ((found == n) & truth).sum() / ((found == n) | truth).sum()
                    for n in range(1, len(objects) + 1)
                )
            )
        truth = labels != LABEL_OF_THE_REST
        right = ((found > 0) & truth).sum()
        hierarchy = tabletop_hierarchy()
        hierarchy.update(parts, pose[:3, 3])
        whole = OctreeMap(0.002)
        whole.insert_scan(pose[:3, 3], upright)
        rows.append(
            [
                path.stem,
                str(len(overlaps)),
                str(len(objects)),
                ", ".join(f"{value:.3f}" for value in overlaps),
                f"{right / (found > 0).sum():.3f}, {right / truth.sum():.3f}",
                f"{spent_s:.2f}",
                f"{whole.memory_bytes() / hierarchy.memory_bytes():.0f} x smaller",
            ]
        )
        if path == paths[0]:
            picture = isometric_picture(_coloured(upright), View(azimuth_rad=2.4, width_px=700))
            picture.save(out / "kinect.png")
    return (
        f"{table(rows)}\n\nObjects that stand on or lean against one another are one segment to a "
        "method that only looks at distances: their IoU is the share of the stack. Clouds of a "
        "Kinect, stood upright by their largest plane.\n\n![First cloud](kinect.png)"
    )


def _coloured(upright: np.ndarray[tuple[int, int], np.dtype[np.float32]]) -> OctreeMap:
    octree = OctreeMap(0.004)
    near = upright[upright[:, 2] > 0.7]
    octree.set_log_odds(near, np.ones(len(near)))
    return octree
