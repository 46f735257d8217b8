import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.slam.pose import (
    between,
    compose,
    compose_jacobians,
    fit_motion,
    inverse,
    transform,
    wrap,
)

NUMBER = st.floats(-50.0, 50.0)
POSE = st.tuples(NUMBER, NUMBER, st.floats(-3.1, 3.1)).map(np.array)


@given(POSE, POSE)
def test_between_undoes_compose(a: np.ndarray, b: np.ndarray) -> None:
    assert np.allclose(compose(a, between(a, b)), b, atol=1e-9)
    assert np.allclose(compose(a, inverse(a)), 0.0, atol=1e-9)


@given(POSE, POSE)
def test_a_point_is_moved_in_one_step_or_in_two(a: np.ndarray, b: np.ndarray) -> None:
    points = np.array([[1.0, 2.0], [-3.0, 0.5]])
    assert np.allclose(transform(compose(a, b), points), transform(a, transform(b, points)))


@given(POSE, POSE)
def test_jacobians_agree_with_differences(a: np.ndarray, b: np.ndarray) -> None:
    by_a, by_b = compose_jacobians(a, b)
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = 1e-6
        for jacobian, moved in ((by_a, (a + step, b)), (by_b, (a, b + step))):
            change = compose(*moved) - compose(a, b)
            change[2] = wrap(change[2])
            assert np.allclose(jacobian[:, axis], change / 1e-6, atol=1e-4)


@given(POSE)
def test_a_motion_is_found_from_points_and_their_images(motion: np.ndarray) -> None:
    points = np.array([[0.0, 0.0], [4.0, 1.0], [2.0, 5.0]])
    found = fit_motion(points, transform(motion, points))
    assert np.allclose(transform(found, points), transform(motion, points), atol=1e-7)


def test_one_point_determines_no_motion() -> None:
    with pytest.raises(ValueError, match="two points or more, not 1"):
        fit_motion(np.zeros((1, 2)), np.zeros((1, 2)))
