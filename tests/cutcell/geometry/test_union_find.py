"""Groups that grow together are those that SciPy finds."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from cutcell.geometry.union_find import find, labels, union


@pytest.mark.parametrize("links", [0, 20, 60, 300])
def test_groups_equal_connected_components(links):
    ends = np.random.default_rng(links).integers(0, 100, (links, 2))
    first = np.arange(100)
    for i, j in ends:
        assert union(first, i, j) == find(first, i) == find(first, j)
    group, lowest = labels(first)
    graph = coo_array((np.ones(links), tuple(ends.T)), shape=(100, 100))
    count, expected = connected_components(graph, directed=False)
    assert len(lowest) == count
    np.testing.assert_array_equal(lowest, np.unique(expected, return_index=True)[1])
    assert len(np.unique(group * 1000 + expected)) == count
