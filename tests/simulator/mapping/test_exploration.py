from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.mapping.exploration import (
    ExplorationParameters,
    Explorer,
    Step,
    at_random,
    frontier_voxels,
    highest_utility,
    nearest_frontier,
    region_entropy,
    region_voxels,
)
from simulator.mapping.octree import OctreeMap
from simulator.mapping.scene import Box as SolidBox
from simulator.mapping.scene import Cup, DepthSensor, Scene, Solid, tabletop_scene
from simulator.mapping.tabletop import TabletopParameters
from simulator.mapping.viewpoints import Viewpoint, look_around

SENSOR = DepthSensor(columns=160, rows=120, horizontal_field_rad=0.9, vertical_field_rad=0.7)
START = look_around((-1.9, -1.5), 1.3, views=8)


def measure(scene: Scene, viewpoint: Viewpoint) -> NDArray[np.float32]:
    return SENSOR.measure(scene, viewpoint.position_m, viewpoint.yaw_rad, viewpoint.pitch_rad)


def explorer(scene: Scene, most_measurements: int) -> Explorer:
    return Explorer(
        SENSOR,
        partial(measure, scene),
        segmentation=TabletopParameters(cluster_distance_m=0.025, smallest_table=300),
        parameters=ExplorationParameters(viewpoints=25, most_measurements=most_measurements),
    )


def on_table(scene: Scene) -> list[Solid]:
    """The objects: what stands at the height of the table."""
    return [
        solid
        for solid in scene.solids
        if (isinstance(solid, Cup) and solid.base_m[2] == 0.75)
        or (isinstance(solid, SolidBox) and solid.centre_m[2] > 0.75 and max(solid.size_m) < 1)
    ]


def within(solid: Solid, points_m: NDArray[np.float64], margin_m: float) -> NDArray[np.bool_]:
    """Points inside a solid, or inside a cup."""
    if isinstance(solid, Cup):
        local = points_m - np.array(solid.base_m)
        across = np.hypot(local[:, 0], local[:, 1]) <= solid.radius_m + margin_m
        return across & (local[:, 2] <= solid.height_m + margin_m)
    assert isinstance(solid, SolidBox)
    c, s = np.cos(solid.yaw_rad), np.sin(solid.yaw_rad)
    local = (points_m - np.array(solid.centre_m)) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return (np.abs(local) <= np.array(solid.size_m) / 2 + margin_m).all(axis=1)


def test_all_objects_are_found_and_only_their_insides_stay_unknown() -> None:
    scene = tabletop_scene(objects=5, seed=3)
    steps = list(explorer(scene, 8).explore(START, highest_utility(2.0)))
    assert steps[-1].chosen is None
    assert 1 < len(steps) <= 8  # ended by its threshold, not by the limit
    model = steps[-1].model
    nodes = [node for node in model.hierarchy.nodes() if node.label == "object"]
    solids = on_table(scene)
    assert len(nodes) == len(solids) == 5
    boxes = [box for node in nodes if (box := node.box()) is not None]
    for solid in solids:
        assert sum(within(solid, box.centre_m[None], 0.01)[0] for box in boxes) == 1
    region = ((-0.55, -0.35, 0.79), (0.55, 0.35, 1.0))
    grid = np.stack(
        np.meshgrid(*[np.arange(a + 0.01, b, 0.02) for a, b in zip(*region, strict=True)]), -1
    ).reshape(-1, 3)
    unknown = grid[np.isnan(model.map.log_odds(grid))]
    inside = np.any([within(solid, unknown, 0.03) for solid in solids], axis=0)
    assert inside.mean() > 0.9
    assert (~inside).sum() < 0.01 * len(grid)


@pytest.mark.slow
def test_information_beats_frontiers_and_chance_after_as_many_measurements() -> None:
    scene = tabletop_scene(objects=5, seed=1)
    region = ((-0.6, -0.4, 0.75), (0.6, 0.4, 1.05))

    def entropy(steps: list[Step]) -> float:
        return region_entropy(steps[-1].model.map, region)

    ours = entropy(list(explorer(scene, 2).explore(START, highest_utility(-100.0))))
    assert ours < entropy(list(explorer(scene, 2).explore(START, nearest_frontier())))
    assert ours < entropy(list(explorer(scene, 2).explore(START, at_random, seed=1)))


def test_an_unknown_region_has_an_entropy_of_ln_2_a_voxel() -> None:
    octree = OctreeMap(0.1)
    region = ((0.0, 0.0, 0.0), (0.4, 0.2, 0.1))
    assert region_voxels(octree, region) == 8
    assert region_entropy(octree, region) == pytest.approx(8 * np.log(2))
    octree.set_log_odds([[0.05, 0.05, 0.05]], [-2.0])
    p = 1 / (1 + np.exp(2.0))
    known = -p * np.log(p) - (1 - p) * np.log(1 - p)
    assert region_entropy(octree, region) == pytest.approx(7 * np.log(2) + known)
    # Its neighbours in the region are unknown, so the free voxel is a frontier.
    assert frontier_voxels(octree, region) == pytest.approx(np.array([[0.05, 0.05, 0.05]]))
    octree.set_log_odds([[0.15, 0.05, 0.05], [0.05, 0.15, 0.05]], [3.5, -2.0])
    assert len(frontier_voxels(octree, region)) == 1
