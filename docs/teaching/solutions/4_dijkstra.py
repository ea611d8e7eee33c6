"""Solution of exercise 4."""

import heapq

import numpy as np


def dijkstra(edges, lengths, sources, count):
    """Return the distance of every node, and the nodes in the order in which they are settled."""
    neighbours = [[] for _ in range(count)]
    for (a, b), length in zip(edges.tolist(), lengths.tolist(), strict=True):
        neighbours[a].append((b, length))
        neighbours[b].append((a, length))
    distance = np.full(count, np.inf)
    queue = []
    for node, start in sources.items():
        distance[node] = start
        heapq.heappush(queue, (start, node))
    order, settled = [], [False] * count
    while queue:
        settled_at, node = heapq.heappop(queue)
        if settled[node]:
            continue
        settled[node] = True
        order.append(node)
        for other, length in neighbours[node]:
            if settled_at + length < distance[other]:
                distance[other] = settled_at + length
                heapq.heappush(queue, (settled_at + length, other))
    return distance, order


def leak(weights, branch, region):
    """Return the mean over a region's vertices of the weight that a branch has there."""
    return weights[region][:, branch].sum(axis=1).mean()
