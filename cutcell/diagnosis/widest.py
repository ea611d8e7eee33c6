"""The part of a weight that is connected along the skin with the vicinity of its joint."""

from __future__ import annotations

from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array

from ..runtime.compiled import compiled
from ..runtime.threads import in_threads


def connected_weights(
    weights: NDArray[np.float64], anchored: NDArray[np.bool_], edges: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Lower weights to what is connected with anchored ones along edges.

    For each joint and vertex: of all paths along edges to a vertex where the joint is anchored,
    the one whose least weight is greatest; that least weight is kept (morphological reconstruction
    by dilation). An island keeps what the valley around it holds. Anchored weights stay.

    Shapes: weights (k, j), anchored (k, j), edges (e, 2); returns (k, j).

    References
    ----------
    Vincent 1993, "Morphological grayscale reconstruction in image analysis".
    """
    ends = np.concatenate([edges, edges[:, ::-1]])
    graph = coo_array((np.ones(len(ends), bool), tuple(ends.T)), shape=(len(weights),) * 2).tocsr()
    start, neighbour = graph.indptr.astype(np.int64), graph.indices.astype(np.int64)
    connected = np.where(anchored, weights, 0.0)
    # A joint whose weight is anchored everywhere needs no search.
    searched = np.flatnonzero((weights > connected).any(axis=0))

    def search(joint: int) -> None:
        column = np.ascontiguousarray(connected[:, joint])
        _spread(start, neighbour, np.ascontiguousarray(weights[:, joint]), column)
        connected[:, joint] = column

    in_threads(search, searched.tolist())
    return connected


@compiled
def _spread(start, neighbour, weight, connected):
    """Spread what is connected to neighbours, the greatest first, as Dijkstra's algorithm does."""
    queue = [(-connected[v], v) for v in range(len(weight)) if connected[v] > 0]
    queue.sort()  # a sorted list is a heap
    while len(queue) > 0:
        negative, v = heappop(queue)
        if -negative < connected[v]:
            continue  # more of it is connected on another path
        for e in range(start[v], start[v + 1]):
            other = neighbour[e]
            least = min(connected[v], weight[other])
            if least > connected[other]:
                connected[other] = least
                heappush(queue, (-least, other))
