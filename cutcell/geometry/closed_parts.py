"""Parts of a mesh that are closed by themselves: they stay apart where they touch each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .edges import NONE
from .triangles import label_components, normals

TURN_STEPS = 1 << 20
"""Of a full turn about an edge: faces within the same step lie on each other."""


def separate_closed_parts(
    vertices: NDArray[np.float64],
    index: NDArray[np.int32],
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """Split welded vertices at which closed parts touch; open parts stay welded to all they touch.

    Shapes: vertices (k, 3), welded; index (n,) and faces (m, 3) of the file's vertices; partner
    (3 m,), see `find_edges`. Returns vertices (k', 3) and index (n,) once split, and the closed
    part of each face, (m,), or NONE.
    """
    corners = index[faces]
    is_whole = np.repeat((corners != np.roll(corners, 1, axis=1)).all(axis=1), 3)
    partner = _pair_around_edges(vertices, corners, partner, is_whole)
    start, end, is_paired = faces.ravel(), np.roll(faces, -1, axis=1).ravel(), partner != NONE
    n, k, used = len(index), len(vertices), np.unique(start[is_whole])
    seam = np.flatnonzero(is_paired & (start != end[partner]))
    seams = np.stack([start[seam], start[partner[seam]]], axis=1)
    links = np.concatenate([faces[:, :2], faces[:, 1:], seams])
    part = label_components(links, n)
    is_open = np.zeros(n + k, np.bool_)
    is_open[part[start[is_whole & ~is_paired]]] = True
    is_open[n + index[used[is_open[part[used]]]]] = True
    welded = used[is_open[n + index[used]]]
    group = label_components(np.stack([part[welded], n + index[welded]], axis=1), n + k)
    is_open = np.bincount(group, is_open) > 0
    closed = group[part[faces[:, 0]]]
    closed = np.where(is_open[closed], NONE, closed).astype(np.int32)

    place, group, group_at = index[used], group[part[used]], np.empty(k, np.int32)
    group_at[place] = group
    if (group_at[place] == group).all():
        return vertices, index, closed
    low, high = np.full(n + k, k), np.full(n + k, NONE)
    np.minimum.at(low, group, place)
    np.maximum.at(high, group, place)
    rank = np.empty(n + k, np.int64)  # whatever the order of faces
    rank[np.lexsort((high, low))] = np.arange(n + k)
    key = index.astype(np.int64) * (n + k)
    key[used] += rank[group]
    keys = np.unique(np.append(key[used], key[np.isin(index, place, invert=True)]))
    return vertices[keys // (n + k)], np.searchsorted(keys, key).astype(np.int32), closed


def _pair_around_edges(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
    is_whole: NDArray[np.bool_],
) -> NDArray[np.int32]:
    """Pair half-edges at edges of many faces: the two faces of a pair have solid between them.

    Without a pair remain those whose edge has no such order, and at the rims of open parts.
    """
    single = np.flatnonzero((partner == NONE) & is_whole)
    start, end = faces.ravel()[single], np.roll(faces, -1, axis=1).ravel()[single]
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, first, which, uses = np.unique(
        low * np.int64(len(vertices)) + high,
        return_index=True,
        return_inverse=True,
        return_counts=True,
    )
    along = vertices[high] - vertices[low]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    out = vertices[np.roll(faces, -2, axis=1).ravel()[single]] - vertices[low]
    out -= (out * along).sum(axis=1, keepdims=True) * along
    reference = out[first][which]
    sine = (along * np.cross(reference, out)).sum(axis=1)
    turn = np.arctan2(sine, (reference * out).sum(axis=1)) / (2 * np.pi)
    turn = np.rint(turn * TURN_STEPS).astype(np.int64) % TURN_STEPS
    # A face whose half-edge runs upward bounds the solid at smaller angles if it faces outward.
    volume = (normals(vertices[faces]) * (vertices[faces[:, 0]] - 0.5)).sum()
    is_last = (start == low) == (volume >= 0)
    order = np.lexsort((~is_last, turn, which))
    following = np.arange(1, len(order) + 1)
    stop = np.cumsum(uses)
    following[stop - 1] = stop - uses
    begins = np.flatnonzero(~is_last[order] & is_last[order[following]])
    one, other = single[order[begins]], single[order[following[begins]]]
    partner = partner.copy()
    partner[one], partner[other] = other, one
    return partner
