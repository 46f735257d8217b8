"""SLAM back end: the most likely poses of a pose graph (thesis 4.2.1), by gtsam.

The thesis's own back end was stochastic gradient descent on a tree (Grisetti et al. 2009); here
it is Levenberg-Marquardt on the sparse normal equations, which finds the same optimum of eq. 4.9.
Wrong constraints are met in three ways: robust kernels, graduated non-convexity (Yang, Antonante,
Tzoumas and Carlone, "Graduated Non-Convexity for Robust Spatial Perception", RA-L 2020) and, before
both, the consensus over constraints of `simulator.slam.consensus`. Redescending kernels alone fail
where a third of the inter-graph edges is wrong and the first frame is unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import gtsam
import numpy as np
from numpy.typing import NDArray

from simulator.slam.pose_graph import Edge, PoseGraph, Sighting, chi2, polar_information

KernelName = Literal["none", "huber", "cauchy", "geman-mcclure", "dcs", "tukey"]
Pose2Factor = Any
_KERNELS: dict[str, Callable[[float], Any]] = {
    "huber": gtsam.noiseModel.mEstimator.Huber.Create,
    "cauchy": gtsam.noiseModel.mEstimator.Cauchy.Create,
    "geman-mcclure": gtsam.noiseModel.mEstimator.GemanMcClure.Create,
    "dcs": gtsam.noiseModel.mEstimator.DCS.Create,
    "tukey": gtsam.noiseModel.mEstimator.Tukey.Create,
}


@dataclass(frozen=True, slots=True)
class BackEndParameters:
    """How a pose graph is optimised."""

    kernel: KernelName = "none"
    """robust kernel on everything but odometry"""
    kernel_width: float = 2.0
    """residual in standard deviations from which a kernel weighs down"""
    max_iterations: int = 100
    relative_tolerance: float = 1e-7
    inlier_probability: float = 0.99
    """share of right constraints that graduated non-convexity means to keep"""


@dataclass(frozen=True, slots=True)
class Optimised:
    """What the back end found."""

    graph: PoseGraph
    chi2_before: float
    chi2_after: float
    """eq. 4.9 over all constraints, without kernel"""
    weights: NDArray[np.float64]
    """(edges,): what graduated non-convexity thinks of each edge, 0 wrong ... 1 right"""


def optimise(graph: PoseGraph, parameters: BackEndParameters | None = None) -> Optimised:
    """Levenberg-Marquardt from the graph's poses; the pose with the smallest key stays.

    Raises:
        ValueError: the graph is malformed, or not connected so that it has no unique optimum.
    """
    parameters = parameters or BackEndParameters()
    factors, values = _factors(graph, parameters), _values(graph)
    settings = gtsam.LevenbergMarquardtParams()
    settings.setMaxIterations(parameters.max_iterations)
    settings.setRelativeErrorTol(parameters.relative_tolerance)
    optimiser = gtsam.LevenbergMarquardtOptimizer(factors, values, settings)
    result = _run(optimiser.optimize)
    better = _read(graph, result)
    return Optimised(better, chi2(graph), chi2(better), np.ones(len(graph.edges)))


def optimise_with_outliers(
    graph: PoseGraph,
    parameters: BackEndParameters | None = None,
    doubtful: tuple[str, ...] = ("inter",),
) -> Optimised:
    """Graduated non-convexity with truncated least squares; odometry counts as right.

    Args:
        graph: poses near enough that the frames of several robots roughly agree: estimate them by
            consensus first.
        parameters: see there.
        doubtful: kinds of edges that may be wrong.

    Raises:
        ValueError: as `optimise`.
    """
    parameters = parameters or BackEndParameters()
    suspects = [place for place, edge in enumerate(graph.edges) if edge.kind in doubtful]
    if not suspects:
        return optimise(graph, parameters)
    factors, values = _factors(graph, replace(parameters, kernel="none")), _values(graph)
    settings = gtsam.GncLMParams(gtsam.LevenbergMarquardtParams())
    settings.setLossType(gtsam.GncLossType.TLS)
    chosen = set(suspects)
    settings.setKnownInliers([place for place in range(factors.size()) if place not in chosen])
    optimiser = gtsam.GncLMOptimizer(factors, values, settings)
    optimiser.setInlierCostThresholdsAtProbability(parameters.inlier_probability)
    better = _read(graph, _run(optimiser.optimize))
    weights = np.asarray(optimiser.getWeights(), dtype=np.float64)[: len(graph.edges)]
    return Optimised(better, chi2(graph), chi2(better), weights)


def joint_covariance(graph: PoseGraph, keys: Sequence[int]) -> NDArray[np.float64]:
    """(3 n, 3 n): covariance of some poses, each block in its pose's own frame.

    Raises:
        ValueError: as `optimise`.
    """
    factors, values = _factors(graph, BackEndParameters()), _values(graph)
    ordered = sorted(set(keys))
    marginals = _run(lambda: gtsam.Marginals(factors, values))
    joint = _run(lambda: marginals.jointMarginalCovariance(list(ordered)))
    blocks = [[joint.at(row, column) for column in keys] for row in keys]
    return np.asarray(np.block(blocks))


class IncrementalBackEnd:
    """iSAM2 (Kaess et al., IJRR 2012): the estimate after each new pose, at little cost."""

    def __init__(self, parameters: BackEndParameters | None = None) -> None:
        self.parameters = parameters or BackEndParameters()
        settings = gtsam.ISAM2Params()
        settings.setRelinearizeThreshold(0.05)
        settings.relinearizeSkip = 1
        self._isam = gtsam.ISAM2(settings)
        self._factors = gtsam.NonlinearFactorGraph()
        self._values = gtsam.Values()
        self._poses: list[int] = []

    def add_pose(self, key: int, guess: NDArray[np.float64]) -> None:
        """A new node; the first one is fixed where it is."""
        if not self._poses:
            self._factors.add(_anchor(key, guess))
        self._values.insert(key, gtsam.Pose2(*guess))
        self._poses.append(key)

    def add_edge(self, edge: Edge) -> None:
        """A new constraint between poses that were added before."""
        self._factors.add(_between(edge, self.parameters))

    def update(self, relinearisations: int = 1) -> dict[int, NDArray[np.float64]]:
        """Takes everything new in and returns all poses.

        Raises:
            ValueError: a pose hangs on no constraint.
        """
        _run(lambda: self._isam.update(self._factors, self._values))
        self._factors = gtsam.NonlinearFactorGraph()
        self._values = gtsam.Values()
        for _ in range(relinearisations - 1):
            self._isam.update()
        estimate = self._isam.calculateEstimate()
        return {key: _pose(estimate.atPose2(key)) for key in self._poses}

    def covariance(self, key: int) -> NDArray[np.float64]:
        """(3, 3) of one pose, in its own frame."""
        return np.asarray(self._isam.marginalCovariance(key))


def _factors(graph: PoseGraph, parameters: BackEndParameters) -> Any:
    graph.check()
    if not graph.poses:
        raise ValueError("the pose graph has no poses")
    factors = gtsam.NonlinearFactorGraph()
    # Edges first, so that a factor's place is its edge's place.
    for edge in graph.edges:
        factors.add(_between(edge, parameters))
    for sighting in graph.sightings:
        factors.add(_bearing_range(sighting, parameters))
    first = min(graph.poses)
    factors.add(_anchor(first, graph.poses[first]))
    return factors


def _anchor(key: int, pose: NDArray[np.float64]) -> Pose2Factor:
    tight = gtsam.noiseModel.Isotropic.Sigma(3, 1e-4)
    return gtsam.PriorFactorPose2(key, gtsam.Pose2(*pose), tight)


def _between(edge: Edge, parameters: BackEndParameters) -> Pose2Factor:
    noise = gtsam.noiseModel.Gaussian.Information(edge.information)
    if edge.kind != "odometry":
        noise = _robust(noise, parameters)
    return gtsam.BetweenFactorPose2(edge.start, edge.end, gtsam.Pose2(*edge.measurement), noise)


def _bearing_range(sighting: Sighting, parameters: BackEndParameters) -> Pose2Factor:
    noise = _robust(gtsam.noiseModel.Gaussian.Information(polar_information(sighting)), parameters)
    x, y = sighting.position_m
    return gtsam.BearingRangeFactor2D(
        sighting.pose,
        gtsam.symbol("l", sighting.landmark),
        gtsam.Rot2(float(np.arctan2(y, x))),
        float(np.hypot(x, y)),
        noise,
    )


def _robust(noise: Any, parameters: BackEndParameters) -> Any:
    if parameters.kernel == "none":
        return noise
    kernel = _KERNELS[parameters.kernel](parameters.kernel_width)
    return gtsam.noiseModel.Robust.Create(kernel, noise)


def _values(graph: PoseGraph) -> Any:
    values = gtsam.Values()
    for key, pose in graph.poses.items():
        values.insert(key, gtsam.Pose2(*pose))
    for key, (x, y) in graph.landmarks.items():
        values.insert(gtsam.symbol("l", key), np.array([x, y]))
    return values


def _read(graph: PoseGraph, values: Any) -> PoseGraph:
    poses = {key: _pose(values.atPose2(key)) for key in graph.poses}
    landmarks = {
        key: np.asarray(values.atPoint2(gtsam.symbol("l", key))) for key in graph.landmarks
    }
    return replace(graph, poses=poses, landmarks=landmarks)


def _pose(pose: Any) -> NDArray[np.float64]:
    return np.array([pose.x(), pose.y(), pose.theta()])


def _run(step: Callable[[], Any]) -> Any:
    try:
        return step()
    except RuntimeError as error:
        said = str(error).strip().splitlines()
        raise ValueError(
            "the pose graph has no unique optimum: every pose and landmark must hang together by "
            f"constraints ({said[0] if said else 'underconstrained'})"
        ) from None
