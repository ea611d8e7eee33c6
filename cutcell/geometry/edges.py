"""The edges of a mesh with their incidence and faces, and edges as adjacency lists."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled, copy_to

NONE = -1
Adjacency: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]


class MeshEdges(NamedTuple):
    """The edges of welded faces.

    Parameters
    ----------
    edges : array, shape (e, 2), int32
        Lower vertex first, sorted.
    incidence : array, shape (e,), int32
        Signed edge incidence: how often faces traverse the edge from the lower to the higher
        vertex, less how often from the higher to the lower. Zero wherever the mesh is closed.
    uses : array, shape (e,), int32
        How many faces without a repeated corner share the edge: one at a rim, two at a manifold
        edge.
    partner : array, shape (3 m,), int32
        Half-edge k of face f runs from its corner k to the next and has the index 3 f + k.
        Its partner is the other half-edge on the same edge if exactly two faces share the edge
        (a manifold edge), else -1. Faces with a repeated corner take no part.
    """

    edges: NDArray[np.int32]
    incidence: NDArray[np.int32]
    uses: NDArray[np.int32]
    partner: NDArray[np.int32]


def find_edges(faces: NDArray[np.int32]) -> MeshEdges:
    """List the edges of welded faces, shape (m, 3), except those from a vertex to itself."""
    return MeshEdges(*_find_edges(faces, int(faces.max(initial=-1)) + 1))


@compiled
def _find_edges(faces, vertices):
    # Two counting sorts of the half-edges: by their higher vertex, then, stable, by their lower.
    by_high = np.zeros(vertices + 1, np.int32)
    by_low = np.zeros(vertices + 1, np.int32)
    for f in range(len(faces)):
        for k in range(3):
            a, b = faces[f, k], faces[f, (k + 1) % 3]
            if a != b:
                by_high[max(a, b) + 1] += 1
                by_low[min(a, b) + 1] += 1
    for v in range(vertices):
        by_high[v + 1] += by_high[v]
        by_low[v + 1] += by_low[v]
    half_edges = by_low[vertices]
    once = np.empty((half_edges, 4), np.int32)  # lower vertex, higher, half-edge, is face whole
    for f in range(len(faces)):
        is_whole = (
            faces[f, 0] != faces[f, 1] and faces[f, 1] != faces[f, 2] and faces[f, 2] != faces[f, 0]
        )
        for k in range(3):
            a, b = faces[f, k], faces[f, (k + 1) % 3]
            if a != b:
                slot = by_high[max(a, b)]
                once[slot, 0], once[slot, 1] = min(a, b), max(a, b)
                once[slot, 2] = 3 * f + k if a < b else ~(3 * f + k)
                once[slot, 3] = is_whole
                by_high[max(a, b)] += 1
    twice = np.empty((half_edges, 4), np.int32)
    for s in range(half_edges):
        low = once[s, 0]
        copy_to(once[s], twice[by_low[low]])
        by_low[low] += 1

    edges = np.empty((half_edges, 2), np.int32)
    incidence, uses = np.empty(half_edges, np.int32), np.empty(half_edges, np.int32)
    partner = np.full(3 * len(faces), NONE, np.int32)
    count, first = 0, 0
    for s in range(half_edges):
        a, b, half_edge, is_whole = twice[s]
        if count == 0 or edges[count - 1, 0] != a or edges[count - 1, 1] != b:
            if s - first == 2:
                _pair(twice[first, 2], twice[first + 1, 2], partner)
            edges[count, 0], edges[count, 1] = a, b
            incidence[count], uses[count] = 0, 0
            count, first = count + 1, s
        incidence[count - 1] += 1 if half_edge >= 0 else -1
        uses[count - 1] += is_whole
    if half_edges - first == 2:
        _pair(twice[first, 2], twice[first + 1, 2], partner)
    return edges[:count].copy(), incidence[:count].copy(), uses[:count].copy(), partner


@compiled(inline="always")
def _pair(one, other, partner):
    one, other = max(one, ~one), max(other, ~other)
    if one // 3 != other // 3:
        partner[one], partner[other] = other, one


@compiled
def list_neighbours(edges, lengths, count):
    """List the neighbours of each of `count` nodes, and their distances if lengths are given.

    Shapes: edges (e, 2), lengths (e,) or (0,); returns indptr (count + 1,), indices and lengths
    (2 e,).
    """
    indptr = np.zeros(count + 1, np.int32)
    for e in range(len(edges)):
        for side in range(2):
            indptr[edges[e, side] + 1] += 1
    for node in range(count):
        indptr[node + 1] += indptr[node]
    cursor, indices = indptr[:-1].copy(), np.empty(2 * len(edges), np.int32)
    both_ways = np.empty(2 * len(lengths))
    for e in range(len(edges)):
        for side in range(2):
            node = edges[e, side]
            indices[cursor[node]] = edges[e, 1 - side]
            if len(lengths):
                both_ways[cursor[node]] = lengths[e]
            cursor[node] += 1
    return indptr, indices, both_ways
