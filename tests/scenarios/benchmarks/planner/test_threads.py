"""One thread and two."""

from planner import read_domain, read_problem
from scenarios.benchmarks.planner.threads import solved
from tests.planner.problems import MATCH_CELLAR


def test_both_find_the_optimum() -> None:
    problem = read_problem(read_domain(MATCH_CELLAR.domain), MATCH_CELLAR.problem)
    runs = [solved(problem, threads, 1, 5.0) for threads in (1, 2)]
    assert [round(run.best, 1) for run in runs] == [8.0, 8.0]
    assert all(run.first >= run.best for run in runs)
