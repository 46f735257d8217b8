"""Who hears whom."""

from service.coordination.exploration.communication_clusters import communication_clusters


def test_robots_relay() -> None:
    line = [(0.0, 0.0), (4.0, 0.0), (8.0, 0.0), (20.0, 0.0)]
    assert communication_clusters(line, 5.0) == ((0, 1, 2), (3,))
    assert communication_clusters(line, 3.0) == ((0,), (1,), (2,), (3,))


def test_without_a_limit_all_are_one_cluster() -> None:
    assert communication_clusters([(0.0, 0.0), (1e5, 0.0)], None) == ((0, 1),)
    assert communication_clusters([], None) == ()
