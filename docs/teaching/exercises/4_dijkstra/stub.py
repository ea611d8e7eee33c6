"""Exercise 4: Dijkstra's search, and the leak that it removes.

walker.npz contains a graph inside of a character: nodes, edges with lengths in metres, and for each
joint the nodes near its bones, with their straight distances to the bone. The shortest path through
the graph is the distance through the body. Fill in both functions; `heapq` of Python helps.

Question 1: Why is the distance of a node final once it is settled? Which edge could break this?
Question 2: Why do the sources not begin at zero?
Question 3: How much of the leak onto the legs is left, and where does it come from?
"""

import numpy as np


def dijkstra(edges, lengths, sources, count):
    """Return the distance of every node, and the nodes in the order in which they are settled.

    Parameters
    ----------
    edges : array of int, shape (m, 2)
        Each edge leads both ways.
    lengths : array, shape (m,)
        Not negative.
    sources : dict of int to float
        Nodes where the search begins, with the distances that they begin with. A shorter path from
        another source replaces the distance.
    count : int
        Number of nodes. Nodes that no path reaches are infinitely far and are never settled.

    Returns
    -------
    distance : array, shape (count,)
    order : list of int
        Of nodes at the same distance, any may come first.
    """
    raise NotImplementedError


def leak(weights, branch, region):
    """Return the mean weight of a branch on a region: summed over joints, averaged over vertices.

    Parameters
    ----------
    weights : array, shape (n, j)
    branch : list of int
        Joints, for example those of an arm.
    region : array of bool, shape (n,)
        Vertices, for example those of the legs.
    """
    raise NotImplementedError
