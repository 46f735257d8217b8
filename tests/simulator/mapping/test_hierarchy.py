import numpy as np
import pytest

from simulator.mapping.hierarchy import (
    ExistenceModel,
    MapHierarchy,
    MapNode,
    NotExclusiveError,
    Segment,
)


def plate(label: str, centre: tuple[float, float, float], edge_m: float) -> Segment:
    """A horizontal square of points."""
    steps = np.linspace(-edge_m / 2, edge_m / 2, 20)
    x, y = np.meshgrid(steps, steps)
    points = np.stack([x.ravel(), 0.7 * y.ravel(), 0.001 * x.ravel() * y.ravel()], axis=1)
    return Segment(label, (points + np.array(centre)).astype(np.float32))


def contains(above: MapNode, below: MapNode) -> bool:
    return above.label == "room" and below.label in ("table", "cup")


def supports(above: MapNode, below: MapNode) -> bool:
    return above.label == "table" and below.label == "cup"


RESOLUTIONS_M = {"room": 0.1, "table": 0.02, "cup": 0.005}
ORIGIN_M = np.array([0.0, 0.0, 3.0])


def by_label(hierarchy: MapHierarchy, part: Segment) -> MapNode | None:
    return next((node for node in hierarchy.nodes() if node.label == part.label), None)


@pytest.fixture
def house() -> tuple[MapHierarchy, MapNode, MapNode, MapNode]:
    hierarchy = MapHierarchy({"contains": contains, "supports": supports}, RESOLUTIONS_M, by_label)
    parts = [
        plate("room", (0, 0, 0), 4.0),
        plate("table", (0.5, 0, 0.7), 1.0),
        plate("cup", (0.6, 0.1, 0.75), 0.1),
    ]
    room, table, cup = hierarchy.update(parts, ORIGIN_M)
    return hierarchy, room, table, cup


def test_a_node_hangs_below_its_deepest_ancestor(
    house: tuple[MapHierarchy, MapNode, MapNode, MapNode],
) -> None:
    hierarchy, room, table, cup = house
    assert hierarchy.roots == [room]
    assert (table.parent, cup.parent, cup.depth) == (room, table, 2)
    assert cup.map.resolution_m == 0.005
    assert cup.T_map_node[:3, 3] == pytest.approx([0.6, 0.1, 0.75], abs=1e-3)


def test_what_stands_on_a_moved_table_moves_with_it(
    house: tuple[MapHierarchy, MapNode, MapNode, MapNode],
) -> None:
    hierarchy, _, table, cup = house
    before = cup.T_map_node[:3, 3].copy()
    surface = cup.map.occupied_voxels()
    shift = np.eye(4)
    shift[:3, 3] = np.linalg.inv(table.T_map_node[:3, :3]) @ [1.0, 0.0, 0.0]
    hierarchy.move(table, shift)
    assert cup.T_map_node[:3, 3] - before == pytest.approx([1.0, 0.0, 0.0])
    assert np.array_equal(cup.map.occupied_voxels(), surface)


def test_measurements_of_a_known_node_do_not_make_another(
    house: tuple[MapHierarchy, MapNode, MapNode, MapNode],
) -> None:
    hierarchy, _, _, cup = house
    existence = cup.existence
    (again,) = hierarchy.update([plate("cup", (0.6, 0.1, 0.75), 0.1)], ORIGIN_M)
    assert again is cup
    assert cup.existence > existence
    assert len(list(hierarchy.nodes())) == 3


def test_a_node_that_is_missed_often_enough_is_removed_with_all_it_carries(
    house: tuple[MapHierarchy, MapNode, MapNode, MapNode],
) -> None:
    hierarchy, room, table, _ = house
    misses = 1
    while not hierarchy.miss(table):
        misses += 1
    assert misses == 2
    assert list(hierarchy.nodes()) == [room]


def test_existence_follows_the_bayes_filter() -> None:
    # Eq. 5.19 with an even prior, two confirmations of 0.7 and a miss of 0.35.
    model = ExistenceModel()
    hierarchy = MapHierarchy({}, {"cup": 0.01}, by_label, existence_model=model)
    for _ in range(2):
        (cup,) = hierarchy.update([plate("cup", (0, 0, 0), 0.1)], ORIGIN_M)
    hierarchy.miss(cup)
    odds = (0.7 / 0.3) ** 2 * (0.35 / 0.65)
    assert cup.existence == pytest.approx(odds / (1 + odds))


def test_relations_that_hold_at_once_are_refused() -> None:
    both = {"contains": contains, "supports": lambda above, _: above.label == "room"}
    hierarchy = MapHierarchy(both, RESOLUTIONS_M, by_label)
    hierarchy.update([plate("room", (0, 0, 0), 4.0)], ORIGIN_M)
    with pytest.raises(NotExclusiveError, match="contains and supports"):
        hierarchy.update([plate("cup", (0, 0, 1), 0.1)], ORIGIN_M)


def wall_behind(hidden: bool) -> Segment:
    """End points of beams from `VIEW_M` past the cup's place: to a wall behind, or to a screen."""
    y, z = np.meshgrid(np.linspace(-0.5, 0.5, 41), np.linspace(0.5, 1.1, 41))
    x = np.full(y.size, -0.2 if hidden else 2.0)
    return Segment("room", np.stack([x, y.ravel(), z.ravel()], axis=1).astype(np.float32))


VIEW_M = np.array([-2.0, 0.0, 0.8])


@pytest.mark.parametrize("hidden", [True, False])
def test_what_beams_pass_through_is_removed_and_what_they_do_not_reach_stays(hidden: bool) -> None:
    hierarchy = MapHierarchy({"contains": contains}, RESOLUTIONS_M, by_label)
    y, z = np.meshgrid(np.linspace(-0.1, 0.1, 15), np.linspace(0.7, 0.9, 15))
    front = np.stack([0.02 * y.ravel() ** 2, y.ravel(), z.ravel()], axis=1)
    cup = Segment("cup", np.concatenate([front, front + np.array([0.1, 0, 0])]).astype(np.float32))
    hierarchy.update([wall_behind(hidden=False), cup], VIEW_M)
    for _ in range(3):
        hierarchy.update([wall_behind(hidden)], VIEW_M)
    labels = [node.label for node in hierarchy.nodes()]
    assert labels == (["room", "cup"] if hidden else ["room"])
