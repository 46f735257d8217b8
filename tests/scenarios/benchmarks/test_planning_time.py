"""The benchmark of figure 3.15 on one small problem."""

from scenarios.benchmarks.planning_time import Measurement, figure, measured, table


def test_a_small_problem_is_solved_to_optimality() -> None:
    found = measured(4, seed=1, limit_s=20.0)
    assert found is not None
    assert found.proved
    assert 0.0 < found.first_s <= found.close_s
    assert found.best_s > 0.0
    assert measured(4, seed=1, limit_s=20.0).best_s == found.best_s  # type: ignore[union-attr]


def test_table_and_figure_group_by_size() -> None:
    found = [
        Measurement(size, seed, 0.1, 0.1 * seed, 50.0, proved=seed == 1)
        for size in (4, 10)
        for seed in (1, 2)
    ]
    text = table(found, 60.0)
    assert "| 10 | 2 | 0.100 | 0.150 | 0.200 | 1 |" in text
    assert figure(found).count("<rect") >= 4
