import networkx as nx
import numpy as np
import pytest

from simulator.slam.clique import maximum_clique


@pytest.mark.parametrize("seed", range(12))
def test_as_large_as_what_networkx_finds(seed: int) -> None:
    random = np.random.default_rng(seed)
    count = int(random.integers(1, 40))
    adjacent = random.random((count, count)) < random.uniform(0.2, 0.9)
    found = maximum_clique(adjacent)
    both = adjacent & adjacent.T
    np.fill_diagonal(both, True)
    assert both[np.ix_(found, found)].all()
    np.fill_diagonal(both, False)
    clique, _ = nx.max_weight_clique(nx.from_numpy_array(both), weight=None)
    assert len(found) == len(clique)


def test_a_large_dense_block_in_noise_is_found_at_once() -> None:
    random = np.random.default_rng(0)
    adjacent = random.random((400, 400)) < 0.1
    adjacent = adjacent | adjacent.T
    adjacent[:150, :150] = True
    assert np.array_equal(maximum_clique(adjacent, node_limit=1000), np.arange(150))


def test_no_vertices_have_no_clique() -> None:
    assert len(maximum_clique(np.zeros((0, 0), dtype=bool))) == 0
