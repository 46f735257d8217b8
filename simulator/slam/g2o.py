"""Pose graphs as text: reads g2o, TORO and iSAM files, writes g2o.

| tag | columns |
|---|---|
| `VERTEX_SE2`, `VERTEX2`, `VERTEX` | key x y heading |
| `VERTEX_XY` | key x y |
| `EDGE_SE2` | start end x y heading, upper triangle of the information matrix row by row |
| `EDGE2`, `EDGE` | the same with TORO's or iSAM's six numbers: see `_information` |
| `ODOMETRY` | start end x y heading, upper triangle of the covariance |
| `EDGE_SE2_XY` | pose landmark x y, upper triangle of the information matrix |
| `LANDMARK` | pose landmark x y, upper triangle of the covariance at 10 m: see `_landmark` |

Kümmerle et al., "g2o: A General Framework for Graph Optimization", ICRA 2011. `ODOMETRY` and edges
between consecutive keys count as odometry, all others as loop closures; in lines that this module
wrote itself, the kind stands after a `#`.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simulator.slam.pose import compose, inverse, transform
from simulator.slam.pose_graph import Edge, EdgeKind, PoseGraph, Sighting

_VERTICES = ("VERTEX_SE2", "VERTEX2", "VERTEX")
_EDGES = ("EDGE_SE2", "EDGE2", "EDGE", "ODOMETRY")
_IGNORED = ("FIX", "EQUIV", "PARAMS_SE2OFFSET")


class PoseGraphFileError(ValueError):
    """A pose graph file that cannot be read: file, line, reason and remedy."""


def read_g2o(path: Path) -> PoseGraph:
    """Reads a pose graph; nodes without a line of their own start where the edges put them.

    Raises:
        PoseGraphFileError: a line is malformed, or a tag is not one of the plane.
        OSError: the file cannot be opened.
    """
    graph = PoseGraph()
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        content, _, comment = line.partition("#")
        words = content.split()
        if not words:
            continue
        try:
            _take(graph, words, comment.strip())
        except (ValueError, IndexError, np.linalg.LinAlgError) as error:
            raise PoseGraphFileError(
                f"{path}:{number}: {' '.join(words[:3])} ...: {error}; "
                "see the columns in `marsupial slam optimise --help`"
            ) from None
    _guess_missing(graph)
    return graph


def _take(graph: PoseGraph, words: list[str], comment: str) -> None:
    tag, values = words[0], words[1:]
    if tag in _VERTICES:
        graph.poses[int(values[0])] = _numbers(values[1:4], 3)
    elif tag == "VERTEX_XY":
        graph.landmarks[int(values[0])] = _numbers(values[1:3], 2)
    elif tag in _EDGES:
        start, end = int(values[0]), int(values[1])
        measurement, six = _numbers(values[2:5], 3), _numbers(values[5:11], 6)
        kind: EdgeKind = "odometry" if tag == "ODOMETRY" or abs(end - start) == 1 else "loop"
        if comment in ("odometry", "loop", "inter"):
            kind = comment  # type: ignore[assignment]  # one of the three
        graph.edges.append(Edge(start, end, measurement, _information(tag, six), kind))
    elif tag in ("EDGE_SE2_XY", "LANDMARK"):
        pose, landmark = int(values[0]), int(values[1])
        at, three = _numbers(values[2:4], 2), _numbers(values[4:7], 3)
        matrix = three[[0, 1, 1, 2]].reshape(2, 2)
        if tag == "LANDMARK":
            matrix = _landmark(at, matrix)
        graph.sightings.append(Sighting(pose, landmark, at, matrix))
    elif tag not in _IGNORED:
        raise ValueError(f"the tag {tag} is not one of planar pose graphs")


def _numbers(words: list[str], count: int) -> NDArray[np.float64]:
    if len(words) < count:
        raise ValueError(f"{count - len(words)} columns are missing")
    values = np.array([float(word) for word in words[:count]])
    if not np.all(np.isfinite(values)):
        raise ValueError("a number is not finite")
    return values


def _symmetric(six: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c, d, e, f = six
    return np.array([[a, b, c], [b, d, e], [c, e, f]])


def _information(tag: str, six: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) from the six numbers of an edge.

    TORO's order is xx xy yy hh xh yh; iSAM writes the upper triangle of a square root of the
    information matrix. Zeros tell them apart, as in gtsam's reader.
    """
    if tag == "EDGE_SE2":
        return _symmetric(six)
    if tag == "ODOMETRY":
        return np.asarray(np.linalg.inv(_symmetric(six)))
    a, b, c, d, e, f = six
    if b == 0.0 and e == 0.0 and f == 0.0 and c != 0.0:
        return np.array([[a, b, e], [b, c, f], [e, f, d]])
    root = np.array([[a, b, c], [0.0, d, e], [0.0, 0.0, f]])
    return np.asarray(root.T @ root)


def _landmark(at: NDArray[np.float64], covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2, 2) information of a sighting in the Victoria Park file.

    As gtsam reads it: one variance v for both axes means v [m^2] in range and v / 10 [rad^2] in
    bearing, whatever the distance.
    """
    if abs(covariance[0, 0] - covariance[1, 1]) > 1e-4:
        return np.asarray(np.linalg.inv(covariance))
    variance, reach = covariance[0, 0], float(np.hypot(*at))
    radial = at / reach
    across = np.array([-radial[1], radial[0]])
    tangential = 10.0 / (variance * reach**2)
    return np.asarray(np.outer(radial, radial) / variance + tangential * np.outer(across, across))


def _guess_missing(graph: PoseGraph) -> None:
    """Poses along the edges from the smallest key on, landmarks from their first sighting."""
    keys = {key for edge in graph.edges for key in (edge.start, edge.end)}
    keys |= {sighting.pose for sighting in graph.sightings}
    if keys and not graph.poses:
        graph.poses[min(keys)] = np.zeros(3)
    waiting = [e for e in graph.edges if e.start not in graph.poses or e.end not in graph.poses]
    progress = True
    while waiting and progress:
        progress, later = False, []
        for edge in waiting:
            if edge.start in graph.poses and edge.end not in graph.poses:
                graph.poses[edge.end] = compose(graph.poses[edge.start], edge.measurement)
                progress = True
            elif edge.end in graph.poses and edge.start not in graph.poses:
                back = inverse(edge.measurement)
                graph.poses[edge.start] = compose(graph.poses[edge.end], back)
                progress = True
            elif edge.start not in graph.poses:
                later.append(edge)
        waiting = later
    for sighting in graph.sightings:
        if sighting.landmark not in graph.landmarks and sighting.pose in graph.poses:
            at = transform(graph.poses[sighting.pose], sighting.position_m[None])[0]
            graph.landmarks[sighting.landmark] = at


def write_g2o(graph: PoseGraph, path: Path) -> None:
    """Writes a pose graph so that reading gives it back to the last bit.

    g2o numbers poses and landmarks together: landmarks whose number a pose has are shifted past
    the largest one.
    """
    if graph.landmarks.keys() & graph.poses.keys():
        shift = max(graph.poses) + 1
        graph = replace(
            graph,
            landmarks={key + shift: at for key, at in graph.landmarks.items()},
            sightings=[replace(s, landmark=s.landmark + shift) for s in graph.sightings],
        )
    lines = [f"VERTEX_SE2 {key} {_words(graph.poses[key])}" for key in sorted(graph.poses)]
    lines += [f"VERTEX_XY {key} {_words(graph.landmarks[key])}" for key in sorted(graph.landmarks)]
    upper = np.triu_indices(3)
    for edge in graph.edges:
        triangle = _words(edge.information[upper])
        natural = "odometry" if abs(edge.end - edge.start) == 1 else "loop"
        note = "" if edge.kind == natural else f" # {edge.kind}"
        measured = _words(edge.measurement)
        lines.append(f"EDGE_SE2 {edge.start} {edge.end} {measured} {triangle}{note}")
    for sighting in graph.sightings:
        triangle = _words(sighting.information[np.triu_indices(2)])
        at = _words(sighting.position_m)
        lines.append(f"EDGE_SE2_XY {sighting.pose} {sighting.landmark} {at} {triangle}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _words(values: NDArray[np.float64]) -> str:
    return " ".join(repr(float(value)) for value in values)
