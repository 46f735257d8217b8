"""Cuts from obstacle to obstacle."""

import numpy as np

from semantic_attachments._core import DistanceTransform
from service.coordination.segmentation.partition import cuts, partition


def test_a_cut_runs_between_the_obstacles_on_both_sides() -> None:
    free = np.ones((9, 12), dtype=np.bool_)
    free[[0, -1]] = False
    free[:, [0, -1]] = False
    free[1:4, 6] = free[6:8, 6] = False
    (cut,) = cuts([4 * 12 + 6], DistanceTransform(~free))
    ends = {cut[0], cut[2]}
    assert cut[1] == (4, 6)
    assert ends == {(3, 6), (6, 6)}
    labels = partition(free, [cut])
    assert labels[4, 2] != labels[4, 9]
    assert ((labels > 0) == free).all()


def test_without_cuts_every_connected_part_is_a_segment() -> None:
    free = np.array([list("..#..")]) == "."
    assert partition(free, []).tolist() == [[1, 1, 0, 2, 2]]


def test_no_step_slips_through_a_slanting_cut() -> None:
    free = np.ones((21, 21), dtype=np.bool_)
    labels = partition(free, [((0, 3), (9, 10), (20, 17))])
    assert labels[10, 0] != labels[10, 20]
    assert len(np.unique(labels)) == 2
