import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from simulator.mapping.oriented_box import OrientedBox, principal_axes

coordinates = st.floats(-2, 2)


def box(centre: list[float], half: list[float], angles: list[float]) -> OrientedBox:
    axes = Rotation.from_euler("xyz", angles).as_matrix()
    return OrientedBox(np.array(centre), axes, np.array(half))


boxes = st.builds(
    box,
    st.lists(coordinates, min_size=3, max_size=3),
    st.lists(st.floats(0.1, 1.0), min_size=3, max_size=3),
    st.lists(st.floats(-3, 3), min_size=3, max_size=3),
)


@given(boxes, boxes)
def test_boxes_with_a_common_point_meet(first: OrientedBox, second: OrientedBox) -> None:
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 9)] * 3), axis=-1).reshape(-1, 3)
    inside = first.centre_m + (grid * first.half_extents_m) @ first.axes.T
    if second.contains(inside).any():
        assert first.meets(second)
    assert first.meets(second) == second.meets(first)


def test_crossed_edges_need_the_nine_cross_products() -> None:
    # Two thin rods turned against each other, one above: no face normal separates them.
    first = box([0, 0, 0], [1, 0.05, 0.05], [np.pi / 4, 0, 0])
    second = box([0, 0, 0.2], [1, 0.05, 0.05], [np.pi / 4, 0, np.pi / 2])
    assert not first.meets(second)
    assert first.meets(box([0, 0, 0.1], [1, 0.05, 0.05], [np.pi / 4, 0, np.pi / 2]))


def test_the_box_around_points_holds_them_along_their_spread() -> None:
    random = np.random.default_rng(0)
    turn = Rotation.from_euler("xyz", [0.3, 0.2, 0.5]).as_matrix()
    points = (random.uniform(-1, 1, (500, 3)) * [3, 2, 1]) @ turn.T + 5
    around = OrientedBox.around(points, margin_m=1e-9)
    assert around.contains(points).all()
    assert sorted(around.half_extents_m, reverse=True) == pytest.approx([3, 2, 1], rel=0.1)
    assert np.linalg.det(principal_axes(points)) == pytest.approx(1.0)


def test_beams_are_cut_where_they_cross_the_box() -> None:
    around = box([2, 0, 0], [0.5, 0.5, 0.5], [0, 0, 0])
    ends = np.array([[4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]])
    enter, leave = around.clip(np.zeros(3), ends)
    assert (enter[0], leave[0]) == pytest.approx((0.375, 0.625))
    assert enter[1] > leave[1]
    assert enter[2] > leave[2]
