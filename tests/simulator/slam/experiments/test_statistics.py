import pytest

from simulator.slam.experiments.statistics import mean_and_half_width, paired_p, table


def test_confidence_interval_by_hand() -> None:
    # Standard deviation 1, standard error 1 / sqrt(3), t(0.975, 2) = 4.3027.
    mean, half = mean_and_half_width([1.0, 2.0, 3.0])
    assert (mean, half) == pytest.approx((2.0, 4.3027 / 3**0.5), rel=1e-4)


def test_paired_test_sees_a_constant_difference() -> None:
    assert paired_p([1.0, 2.0, 3.1], [0.0, 1.05, 2.0]) < 0.01
    assert paired_p([1.0, 2.0, 3.0], [2.0, 1.0, 3.1]) > 0.5


def test_tables_are_markdown() -> None:
    assert table(["a", "b"], [[1, 2]]) == "| a | b |\n| --- | --- |\n| 1 | 2 |"
