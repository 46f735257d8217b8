"""Hierarchies of 3D maps (Wurm, section 5.3).

Every node has a map of its own in a frame of its own, `T_parent_node`, so that submaps can be
moved, removed and resolved independently.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import exp, log

import numpy as np
from numpy.typing import NDArray

from simulator.mapping.octree import OctreeMap, SensorModel
from simulator.mapping.oriented_box import OrientedBox, principal_axes

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Segment:
    """Part of a measurement that belongs to one structure (eq. 5.16)."""

    label: str
    points_m: NDArray[np.float32]
    """`(n, 3)`, map frame."""


@dataclass(frozen=True, slots=True)
class ExistenceModel:
    """Inverse sensor model of a node's existence (eq. 5.19), as probabilities."""

    confirmed: float = 0.7
    """When part of a measurement was integrated into the node."""
    missed: float = 0.35
    """When none was, though the node lay open within the field of view."""
    prior: float = 0.5
    lowest: float = 0.02
    highest: float = 0.98
    seen_through: float = 0.2
    """A node lay open if this share of the beams towards it passed through its box."""
    fewest_beams: int = 20
    """Towards a node, for its absence to be noticed."""


@dataclass(eq=False)
class MapNode:
    """A node of the hierarchy (eq. 5.13)."""

    id: int
    label: str
    map: OctreeMap
    T_parent_node: Array
    """Pose of the node in its parent's frame `(4, 4)`."""
    parent: "MapNode | None" = None
    children: list["MapNode"] = field(default_factory=list)
    existence: float = 0.5
    """Probability that what the node models is still there."""
    _extent_m: tuple[Array, Array] | None = None

    @property
    def depth(self) -> int:
        """0 for a root."""
        return 0 if self.parent is None else self.parent.depth + 1

    @property
    def T_map_node(self) -> Array:
        """Pose of the node in the map frame (eq. 5.15)."""
        if self.parent is None:
            return self.T_parent_node
        return self.parent.T_map_node @ self.T_parent_node

    def to_node(self, points_m: NDArray[np.floating]) -> Array:
        """Points `(n, 3)` of the map frame in the node's frame."""
        inverse = np.linalg.inv(self.T_map_node)
        return np.asarray(points_m @ inverse[:3, :3].T + inverse[:3, 3], dtype=np.float64)

    def box(self) -> OrientedBox | None:
        """Box around the node's measured surface, in the map frame; None before the first
        measurement."""
        if self._extent_m is None:
            return None
        low, high = self._extent_m
        pose = self.T_map_node
        centre = pose[:3, :3] @ ((low + high) / 2) + pose[:3, 3]
        return OrientedBox(centre, pose[:3, :3], (high - low) / 2)

    def cover(self, local_m: Array) -> tuple[Array, Array]:
        """Grows the node's extent over points `(n, 3)` of its frame; returns its corners."""
        low, high = local_m.min(axis=0), local_m.max(axis=0)
        if self._extent_m is not None:
            low, high = np.minimum(low, self._extent_m[0]), np.maximum(high, self._extent_m[1])
        self._extent_m = (low, high)
        return low, high

    def integrate(self, points_m: NDArray[np.floating], origin_m: Array, margin_m: float) -> None:
        """Adds beams that end in the node (eq. 5.23), cut at its box: free space beyond is not its
        business."""
        local = self.to_node(points_m)
        origin = self.to_node(origin_m[None])[0]
        low, high = self.cover(local)
        self.map.insert_scan(origin, local, bounds_m=(low - margin_m, high + margin_m))


Relation = Callable[[MapNode, MapNode], bool]
"""`relation(above, below)`: whether the first node is above the second in the hierarchy."""

Association = Callable[["MapHierarchy", Segment], MapNode | None]
"""The lowest node that a segment falls into, if any."""


class NotExclusiveError(ValueError):
    """Two relations hold between the same nodes, so the hierarchy is not defined (section
    5.3.2)."""


class MapHierarchy:
    """A tree of maps, built by user-defined spatial relations.

    Args:
        relations: by name, mutually exclusive.
        resolutions_m: voxel size of each label's maps [m].
    """

    def __init__(
        self,
        relations: Mapping[str, Relation],
        resolutions_m: Mapping[str, float],
        association: Association,
        sensor_model: SensorModel | None = None,
        existence_model: ExistenceModel | None = None,
    ) -> None:
        self.relations = dict(relations)
        self.resolutions_m = dict(resolutions_m)
        self.association = association
        self.sensor_model = sensor_model or SensorModel()
        self.existence_model = existence_model or ExistenceModel()
        self.roots: list[MapNode] = []
        self._next_id = 0

    def __contains__(self, node: MapNode) -> bool:
        return any(node is other for other in self.nodes())

    def nodes(self) -> Iterator[MapNode]:
        """All nodes, parents before children, in the order of their ids among siblings."""
        pending = list(reversed(self.roots))
        while pending:
            node = pending.pop()
            yield node
            pending.extend(reversed(node.children))

    def update(self, segments: Sequence[Segment], origin_m: Array) -> list[MapNode]:
        """Adds a segmented measurement taken at `origin_m` `(3,)`, map frame; returns the nodes it
        went to.

        Segments that no node takes become nodes of their own (section 5.3.3). Nodes that nothing
        went to although beams passed through where they should be become less likely, and are
        removed when it is more likely that they are gone.
        """
        touched: list[MapNode] = []
        for segment in segments:
            node = self.association(self, segment)
            if node is None:
                node = self.add(segment)
            node.integrate(segment.points_m, origin_m, margin_m=3 * node.map.resolution_m)
            self._observe(node, self.existence_model.confirmed)
            touched.append(node)
        if segments:
            points_m = np.concatenate([segment.points_m for segment in segments])
            for node in list(self.nodes()):
                if node not in touched and self._lies_open(node, points_m, origin_m):
                    self.miss(node)
        return touched

    def _lies_open(self, node: MapNode, points_m: NDArray[np.floating], origin_m: Array) -> bool:
        """Whether beams passed through a node's box that would have met what it models."""
        box = node.box()
        if box is None:
            return False
        # Surfaces that the node stands on or leans against touch its box: only its core counts.
        core = OrientedBox(box.centre_m, box.axes, 0.8 * box.half_extents_m)
        enter, leave = core.clip(origin_m, points_m)
        towards = (enter <= leave) & (leave > 0)
        through = towards & (leave < 1)
        model = self.existence_model
        return bool(
            towards.sum() >= model.fewest_beams
            and through.sum() >= model.seen_through * towards.sum()
        )

    def add(self, segment: Segment) -> MapNode:
        """A new node for a segment, framed by its principal axes, below its deepest ancestor (eq.
        5.18)."""
        pose = np.eye(4)
        pose[:3, :3] = principal_axes(segment.points_m)
        pose[:3, 3] = segment.points_m.mean(axis=0)
        node = MapNode(
            id=self._next_id,
            label=segment.label,
            map=OctreeMap(self.resolutions_m[segment.label], self.sensor_model),
            T_parent_node=pose,
            existence=self.existence_model.prior,
        )
        self._next_id += 1
        ancestor = self._ancestor(node)
        if ancestor is None:
            self.roots.append(node)
        else:
            node.T_parent_node = np.linalg.inv(ancestor.T_map_node) @ pose
            node.parent = ancestor
            ancestor.children.append(node)
        return node

    def _ancestor(self, new: MapNode) -> MapNode | None:
        candidates = []
        for node in self.nodes():
            holding = [name for name, relation in self.relations.items() if relation(node, new)]
            if len(holding) > 1:
                raise NotExclusiveError(
                    f"nodes {node.id} ({node.label}) and {new.id} ({new.label}) are related by "
                    f"{' and '.join(holding)}: relations must be mutually exclusive"
                )
            if holding:
                candidates.append(node)
        return max(candidates, key=lambda node: node.depth, default=None)

    def move(self, node: MapNode, transform: Array) -> None:
        """Moves a node, and all below it, by a transform `(4, 4)` in its own frame (section
        5.3.3)."""
        node.T_parent_node = node.T_parent_node @ transform

    def merge(self, node: MapNode, other: MapNode) -> None:
        """Takes what another node models into a node, where that knows nothing, and removes it.

        For structures that were first seen in parts.
        """
        centres, log_odds = other.map.known_voxels()
        pose = other.T_map_node
        local = node.to_node(centres @ pose[:3, :3].T + pose[:3, 3])
        new = np.isnan(node.map.log_odds(local))
        node.map.set_log_odds(local[new], log_odds[new])
        surface = local[log_odds >= 0]
        if len(surface):
            node.cover(surface)
        node.existence = max(node.existence, other.existence)
        for child in list(other.children):
            child.T_parent_node = np.linalg.inv(node.T_map_node) @ child.T_map_node
            child.parent = node
            node.children.append(child)
        other.children.clear()
        self.remove(other)

    def miss(self, node: MapNode) -> bool:
        """Counts a measurement that should have seen the node and did not; True if the node is
        removed for it."""
        self._observe(node, self.existence_model.missed)
        if node.existence >= 0.5:
            return False
        self.remove(node)
        return True

    def remove(self, node: MapNode) -> None:
        """Removes a node with all below it."""
        siblings = self.roots if node.parent is None else node.parent.children
        siblings.remove(node)
        node.parent = None

    def _observe(self, node: MapNode, probability: float) -> None:
        model = self.existence_model
        log_odds = _log_odds(node.existence) + _log_odds(probability) - _log_odds(model.prior)
        node.existence = min(max(1 / (1 + exp(-log_odds)), model.lowest), model.highest)

    def memory_bytes(self) -> int:
        """Bytes of all maps."""
        return sum(node.map.memory_bytes() for node in self.nodes())


def _log_odds(probability: float) -> float:
    return log(probability / (1 - probability))
