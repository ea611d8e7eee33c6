"""Shortest paths along the links between voxels."""

from __future__ import annotations

from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array

from ..runtime.compiled import compiled
from ..runtime.threads import in_threads, parts


def path_lengths(
    count: int,
    links: NDArray[np.int32],
    lengths: NDArray[np.float64],
    sources: list[NDArray[np.intp]],
    starts: list[NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Compute how far every node is from each set of sources (Dijkstra's algorithm).

    Shapes: links (e, 2), lengths (e,); returns (sets, count).
    """
    a, b = links.T
    both = (np.concatenate([a, b]), np.concatenate([b, a]))
    matrix = coo_array((np.concatenate([lengths, lengths]), both), shape=(count, count)).tocsr()
    first = np.cumsum([0, *(len(nodes) for nodes in sources)])
    graph = matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64), matrix.data
    source = np.concatenate(sources).astype(np.int64)
    start = np.concatenate(starts).astype(np.float64)
    blocks = in_threads(
        lambda part: _search(*graph, first[part.start : part.stop + 1], source, start),
        parts(len(sources)),
    )
    return np.concatenate(blocks)


@compiled
def _search(indptr, indices, lengths, first, source, start):
    result = np.full((len(first) - 1, len(indptr) - 1), np.inf)
    for one in range(len(first) - 1):
        distance = result[one]
        queue = [(np.inf, -1)]
        for s in range(first[one], first[one + 1]):
            if start[s] < distance[source[s]]:
                distance[source[s]] = start[s]
                heappush(queue, (start[s], source[s]))
        while True:
            reached, node = heappop(queue)
            if node < 0:
                break
            if reached > distance[node]:
                continue  # on a shorter path since
            for e in range(indptr[node], indptr[node + 1]):
                further = reached + lengths[e]
                if further < distance[indices[e]]:
                    distance[indices[e]] = further
                    heappush(queue, (further, indices[e]))
    return result
