"""Weight that jumps a gap: parts close in space but far from each other through the body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from cutcell.checks import check_integer, check_number
from cutcell.errors import ParameterError
from cutcell.graph import CutCellGraph

from .weight_error import checked_weights

NEAR = 0.05
"""Of the longest side: vertices within it face each other across a gap."""
FAR = 0.25
"""Of the longest side: a path through the body at least this long makes it a gap."""
SEED = 0
BLOCK = 64
"""Searches at once; each keeps a distance for every node."""


@dataclass(frozen=True, eq=False)
class Crosstalk:
    """How much weight the two sides of gaps share.

    Parameters
    ----------
    mean : float
        Over all pairs, the mean of `overlap`; nan where the character has no gap.
    overlap : array, shape (p,)
        For each pair the weight that both vertices give to the same joints, 0 to 1.
    pairs : array, shape (p, 2), int32
        Vertices that face each other.
    """

    mean: float
    overlap: NDArray[np.float64]
    pairs: NDArray[np.int32]


def find_gaps(
    graph: CutCellGraph, *, near: float = NEAR, far: float = FAR, searches: int = 512
) -> NDArray[np.int32]:
    """Find pairs of vertices that are close in space and far from each other in the body.

    Parameters
    ----------
    graph : CutCellGraph
        Of the mesh; its paths run through the body.
    near, far : float
        In unit-cube lengths, the longest side of the mesh being 1.
    searches : int
        Vertices to search from, at most, drawn evenly and always the same ones.

    Returns
    -------
    array, shape (p, 2), int32
        Vertices of the file, one for each welded vertex. Components that no edge joins are
        no pair: a sleeve should follow its arm.

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    near = check_number("near", near, 0, 1)
    far = check_number("far", far, near, 10)
    searches = check_integer("searches", searches, 1, 1_000_000)
    nodes, vertex = np.unique(graph.vertex_node, return_index=True)
    neighbours = cKDTree(graph.nodes[nodes]).query_pairs(near, output_type="ndarray")
    starts = np.unique(neighbours[:, 0])
    if len(starts) > searches:
        starts = np.sort(np.random.default_rng(SEED).permutation(starts)[:searches])
        neighbours = neighbours[np.isin(neighbours[:, 0], starts)]
    neighbours = neighbours[np.lexsort(neighbours.T[::-1])]
    matrix = graph.csr()
    component = connected_components(matrix, directed=False)[1]
    gaps = [np.empty((0, 2), np.intp)]
    for first in range(0, len(starts), BLOCK):
        part = starts[first : first + BLOCK]
        reach = dijkstra(matrix, indices=nodes[part], limit=far)
        begin, end = np.searchsorted(neighbours[:, 0], [part[0], part[-1] + 1])
        a, b = neighbours[begin:end].T
        beyond = ~np.isfinite(reach[np.searchsorted(part, a), nodes[b]])
        together = component[nodes[a]] == component[nodes[b]]
        gaps.append(neighbours[begin:end][beyond & together])
    return vertex[np.concatenate(gaps)].astype(np.int32)


def crosstalk(weights: ArrayLike, pairs: ArrayLike) -> Crosstalk:
    """Measure the weight that both sides of gaps give to the same joints.

    Parameters
    ----------
    weights : array_like, shape (n, j)
    pairs : array_like, shape (p, 2)
        From `find_gaps`.

    Returns
    -------
    Crosstalk

    Raises
    ------
    WeightsError
        No weights.
    ParameterError
        Pairs of vertices that the weights are not for.
    """
    array = checked_weights(weights, "weights")
    ends = np.asarray(pairs, np.int64)
    if ends.ndim != 2 or ends.shape[1] != 2:
        raise ParameterError(f"pairs have the shape {ends.shape}, expected (p, 2)")
    if len(ends) and not (ends.min() >= 0 and ends.max() < len(array)):
        raise ParameterError(f"pairs name vertices beyond the {len(array)} that have weights")
    overlap = np.minimum(array[ends[:, 0]], array[ends[:, 1]]).sum(axis=1)
    mean = float(overlap.mean()) if len(overlap) else float("nan")
    return Crosstalk(mean, overlap, ends.astype(np.int32))
