"""Local changes of a closed triangle mesh, many at a time.

Each function picks edges that share no triangle, best first, changes all of them at once,
and starts again until no edge is left to change. The mesh stays closed and manifold.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

LONG, SHORT = 4 / 3, 4 / 5
"""Edges outside of this range, relative to the wanted length, are split or collapsed."""

SLIVER = 0.08
"""Triangles lower than this, relative to their longest side, have no shape to keep."""

ENOUGH = 0.001
"""Stop collapsing when fewer edges than this, of all, can be collapsed at once."""

TURN = 0.5
"""Cosine of the most that a triangle's normal may turn in one change."""


def split_long_edges(
    vertices: NDArray, faces: NDArray, wanted: NDArray, rounds: int = 20
) -> tuple[NDArray, NDArray, NDArray]:
    """Halve edges that are too long; return vertices, faces and wanted lengths."""
    for _ in range(rounds):
        edges, sides = edges_of(faces)
        ratio = _ratio(vertices, edges, wanted)
        chosen = _apart(ratio > LONG, -ratio, sides // 3, len(faces))
        if not len(chosen):
            break
        a, b = edges[chosen].T
        middle = len(vertices) + np.arange(len(chosen))
        vertices = np.concatenate([vertices, (vertices[a] + vertices[b]) / 2])
        wanted = np.concatenate([wanted, (wanted[a] + wanted[b]) / 2])
        faces = _split_faces(faces, sides[chosen], middle)
    return vertices, faces, wanted


def collapse_short_edges(
    vertices: NDArray, faces: NDArray, wanted: NDArray, rounds: int = 100
) -> tuple[NDArray, NDArray, NDArray]:
    """Shrink edges that are too short to a point; return vertices, faces, wanted lengths."""
    refused = np.zeros(0, np.int64)
    stamp = np.arange(len(vertices))  # lasting names of vertices, to remember refused edges
    total = len(vertices)
    for _ in range(rounds):
        edges, _ = edges_of(faces)
        ratio = _ratio(vertices, edges, wanted)
        keys = stamp[edges[:, 0]] * total + stamp[edges[:, 1]]
        ring = _adjacency(edges, len(vertices))
        candidate = (ratio < SHORT) & ~np.isin(keys, refused)
        candidate[candidate] = _link_holds(ring, edges[candidate])
        chosen = _rings_apart(candidate, ratio, edges, len(vertices))
        if len(chosen) <= ENOUGH * len(edges):
            break
        good = _collapse_is_good(vertices, faces, wanted, edges[chosen])
        refused = np.union1d(refused, keys[chosen[~good]])
        vertices, faces, remaining = _collapse(vertices, faces, edges[chosen[good]])
        wanted, stamp = wanted[remaining], stamp[remaining]
    return vertices, faces, wanted


def flip_edges(vertices: NDArray, faces: NDArray, rounds: int = 30) -> NDArray:
    """Flip edges while that brings the vertices closer to six neighbours; return faces."""
    for _ in range(rounds):
        edges, sides = edges_of(faces)
        a, b = edges.T
        c, d = (_opposite(faces, sides[:, k]) for k in range(2))
        degree = np.bincount(edges.ravel(), minlength=len(vertices))
        before = sum(np.abs(degree[v] - 6) ** 2 for v in (a, b, c, d))
        after = sum(np.abs(degree[v] - 7) ** 2 for v in (a, b))
        after = after + sum(np.abs(degree[v] - 5) ** 2 for v in (c, d))
        candidate = (after < before) & (degree[a] > 3) & (degree[b] > 3)
        count = len(vertices)
        present = np.minimum(a, b) * count + np.maximum(a, b)
        candidate &= ~np.isin(np.minimum(c, d) * count + np.maximum(c, d), present)
        rows = np.flatnonzero(candidate)
        candidate[rows] = _flip_is_good(vertices, faces, sides[rows])
        chosen = _apart(candidate, after - before, np.stack([a, b, c, d], 1), count)
        if not len(chosen):
            break
        faces = _flip(faces, sides[chosen])
    return faces


def flip_thin(
    vertices: NDArray, faces: NDArray, labels: NDArray, thin: float = 0.35, rounds: int = 10
) -> tuple[NDArray, NDArray]:
    """Flip edges of thin triangles, if that mends them; return faces and their labels.

    Only between faces of the same label, or if one of them is a sliver: both get the other's.
    """
    labels = labels.copy()
    for _ in range(rounds):
        edges, sides = edges_of(faces)
        a, b = edges.T
        c, d = (_opposite(faces, sides[:, k]) for k in range(2))
        one, two = sides.T // 3
        shapes = _shape(vertices[faces])
        before = np.minimum(shapes[one], shapes[two])
        after = np.minimum(*(_shape(vertices[f]) for f in _flipped(faces, sides)))
        candidate = (before < thin) & (after > 1.2 * before)
        candidate &= (labels[one] == labels[two]) | (before < SLIVER)
        count = len(vertices)
        present = np.minimum(a, b) * count + np.maximum(a, b)
        candidate &= ~np.isin(np.minimum(c, d) * count + np.maximum(c, d), present)
        facing = np.ones(len(edges), bool)
        for new in _flipped(faces, sides):
            n = np.cross(*np.diff(vertices[new], axis=1).transpose(1, 0, 2))
            for old in (one, two):
                m = np.cross(*np.diff(vertices[faces[old]], axis=1).transpose(1, 0, 2))
                # A triangle without area has no side to compare with.
                facing &= ((n * m).sum(axis=1) > 0) | (shapes[old] < SLIVER)
        chosen = _apart(candidate & facing, before, np.stack([a, b, c, d], 1), count)
        if not len(chosen):
            break
        pair = np.stack([one, two], axis=1)[chosen]
        wider = np.take_along_axis(pair, shapes[pair].argmax(axis=1)[:, None], axis=1)
        labels[pair] = labels[wider]
        faces = _flip(faces, sides[chosen])
    return faces, labels


def edges_of(faces: NDArray) -> tuple[NDArray, NDArray]:
    """Return the edges of a closed mesh and their two sides.

    Returns
    -------
    edges : array, shape (e, 2)
        Ends, the lower index first.
    sides : array, shape (e, 2)
        The two half-edges: 3 * face + k runs from corner k of the face to the next. The
        first of them runs from the edge's first end to its second.

    Raises
    ------
    ValueError
        An edge has not exactly two, opposite sides.
    """
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    count = int(faces.max()) + 1
    forward = start < end
    keys = np.where(forward, start * count + end, end * count + start)
    order = np.lexsort((~forward, keys))
    keys = keys[order].reshape(-1, 2) if len(keys) % 2 == 0 else np.zeros((0, 2))
    sides = order.reshape(-1, 2) if len(order) % 2 == 0 else np.zeros((0, 2), int)
    closed = len(sides) and (keys[:, 0] == keys[:, 1]).all() and (np.diff(keys[:, 0]) > 0).all()
    if not closed or not (forward[sides[:, 0]] & ~forward[sides[:, 1]]).all():
        raise ValueError("the mesh is not closed: an edge has not two opposite triangles")
    return np.stack([start[sides[:, 0]], end[sides[:, 0]]], axis=1), sides


def _ratio(vertices: NDArray, edges: NDArray, wanted: NDArray) -> NDArray:
    a, b = edges.T
    span = vertices[a] - vertices[b]
    return np.sqrt((span * span).sum(axis=1)) * 2 / (wanted[a] + wanted[b])


def _opposite(faces: NDArray, sides: NDArray) -> NDArray:
    return faces[sides // 3, (sides % 3 + 2) % 3]


def _ranks(candidate: NDArray, cost: NDArray) -> tuple[NDArray, NDArray]:
    """Return the candidates, cheapest first, and each edge's place among them."""
    rows = np.flatnonzero(candidate)
    rows = rows[np.argsort(cost[rows], kind="stable")]
    rank = np.full(len(candidate), len(candidate))
    rank[rows] = np.arange(len(rows))
    return rows, rank


def _apart(candidate: NDArray, cost: NDArray, touched: NDArray, count: int) -> NDArray:
    """Pick candidates that are the cheapest on all the things (e, k) they touch."""
    rows, rank = _ranks(candidate, cost)
    best = np.full(count, len(candidate))
    for column in touched.T:
        np.minimum.at(best, column[rows], rank[rows])
    return rows[(best[touched[rows]] == rank[rows, None]).all(axis=1)]


def _rings_apart(candidate: NDArray, cost: NDArray, edges: NDArray, count: int) -> NDArray:
    """Pick candidates that are the cheapest in the neighbourhood of both their ends."""
    rows, rank = _ranks(candidate, cost)
    best = np.full(count, len(candidate))
    for column in edges.T:
        np.minimum.at(best, column[rows], rank[rows])
    wide = best.copy()
    np.minimum.at(wide, edges[:, 0], best[edges[:, 1]])
    np.minimum.at(wide, edges[:, 1], best[edges[:, 0]])
    return rows[(wide[edges[rows]] == rank[rows, None]).all(axis=1)]


def _adjacency(edges: NDArray, count: int) -> sparse.csr_array:
    ones = np.ones(len(edges), np.int32)
    half = sparse.csr_array((ones, (edges[:, 0], edges[:, 1])), shape=(count, count))
    return (half + half.T).tocsr()


def _link_holds(ring: sparse.csr_array, edges: NDArray) -> NDArray:
    """Whether the ends share just two neighbours; else collapsing would pinch the surface."""
    if not len(edges):
        return np.zeros(0, bool)
    shared = ring[edges[:, 0]].multiply(ring[edges[:, 1]]).sum(axis=1)
    degree = np.diff(ring.indptr)
    return (np.asarray(shared).ravel() == 2) & (degree[edges].min(axis=1) > 3)


def _collapse_is_good(
    vertices: NDArray, faces: NDArray, wanted: NDArray, edges: NDArray
) -> NDArray:
    owner = np.full(len(vertices), -1)
    owner[edges] = np.arange(len(edges))[:, None]
    moved = vertices.copy()
    moved[edges] = vertices[edges].mean(axis=1, keepdims=True)
    who = owner[faces].max(axis=1)
    touched = np.flatnonzero((who >= 0) & ((owner[faces] == who[:, None]).sum(axis=1) == 1))
    corners, who = faces[touched], who[touched]
    bad = _turned(vertices[corners], moved[corners])
    long = np.sqrt(((moved[corners] - np.roll(moved[corners], 1, axis=1)) ** 2).sum(axis=2))
    bad |= long.max(axis=1) > LONG * wanted[corners].mean(axis=1)
    good = np.ones(len(edges), bool)
    good[who[bad]] = False
    return good


def _shape(triangles: NDArray) -> NDArray:
    """Return twice the area over the longest side squared: 0.87 at best, 0 for slivers."""
    n = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    sides = ((triangles - np.roll(triangles, 1, axis=1)) ** 2).sum(axis=2)
    return np.sqrt((n * n).sum(axis=1)) / sides.max(axis=1)


def _turned(before: NDArray, after: NDArray) -> NDArray:
    """Whether triangles (m, 3, 3) turn too far, or lose their shape."""
    n, m = (np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]) for t in (before, after))
    sizes = np.sqrt((n * n).sum(axis=1) * (m * m).sum(axis=1))
    thin, was_thin = _shape(after) < 0.15, _shape(before) < 0.15
    return ((n * m).sum(axis=1) < TURN * sizes) & ~was_thin | thin & ~was_thin


def _collapse(
    vertices: NDArray, faces: NDArray, edges: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    a, b = edges.T
    vertices = vertices.copy()
    vertices[a] = (vertices[a] + vertices[b]) / 2
    target = np.arange(len(vertices))
    target[b] = a
    faces = target[faces]
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    alive = np.ones(len(vertices), bool)
    alive[b] = False
    remaining = np.flatnonzero(alive)
    number = np.full(len(vertices), -1)
    number[remaining] = np.arange(len(remaining))
    return vertices[remaining], number[faces], remaining


def _split_faces(faces: NDArray, sides: NDArray, middle: NDArray) -> NDArray:
    faces = faces.copy()
    new = []
    for column in sides.T:
        face, k = column // 3, column % 3
        half = faces[face].copy()
        half[np.arange(len(face)), k] = middle
        faces[face, (k + 1) % 3] = middle
        new.append(half)
    return np.concatenate([faces, *new])


def _flipped(faces: NDArray, sides: NDArray) -> tuple[NDArray, NDArray]:
    """Return the two triangles that each edge's two become."""
    first, second = sides.T
    a = faces[first // 3, first % 3]
    b = faces[second // 3, second % 3]
    c, d = _opposite(faces, first), _opposite(faces, second)
    return np.stack([c, a, d], axis=1), np.stack([d, b, c], axis=1)


def _flip_is_good(vertices: NDArray, faces: NDArray, sides: NDArray) -> NDArray:
    good = np.ones(len(sides), bool)
    for new in _flipped(faces, sides):
        for old in sides.T:
            good &= ~_turned(vertices[faces[old // 3]], vertices[new])
    return good


def _flip(faces: NDArray, sides: NDArray) -> NDArray:
    faces = faces.copy()
    one, two = _flipped(faces, sides)
    faces[sides[:, 0] // 3], faces[sides[:, 1] // 3] = one, two
    return faces
