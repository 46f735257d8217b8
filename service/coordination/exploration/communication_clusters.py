"""Clusters of robots that hear one another, directly or through others (Wurm, end of 2.5)."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial.distance import pdist, squareform


def communication_clusters(
    positions_m: Sequence[tuple[float, float]], range_m: float | None
) -> tuple[tuple[int, ...], ...]:
    """Indices of the robots of each cluster, ascending; all in one if the range is unlimited."""
    if not positions_m:
        return ()
    if range_m is None:
        return (tuple(range(len(positions_m))),)
    apart_m = squareform(pdist(np.asarray(positions_m, dtype=np.float64)))
    _, labels = connected_components(coo_array(apart_m <= range_m), directed=False)
    return tuple(
        tuple(np.flatnonzero(labels == label).tolist()) for label in dict.fromkeys(labels.tolist())
    )
