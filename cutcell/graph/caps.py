"""Caps that close the holes of a mesh, so that counting crossings is nearly enough.

With every hole capped, the signed count of crossings is a whole number: the winding
number of the closed surface. The mesh's own number is less by what the caps cover of the
view, see `holes.py`. Any caps will do; small ones leave less in doubt.

A loop of edges is capped by a fan of triangles around its middle. That is far from small
where many loops have narrow gaps between them, as in a soup of triangles that nearly touch:
there all rims are first drawn together. Each edge a -> b is tied by a strip a, b, b', a' to
the edge between the places where its ends are drawn to; what then fits together cancels, and
only what is left needs fans. Where faces run against their neighbours, the rim between them counts
twice; these faces themselves, turned round and twice, are often smaller than fans along it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled, lean
from ..threads import in_threads
from .boundary import Boundary, boundary_of, find_boundary
from .patches import inconsistent_faces
from .solid_angle import between, cross, length
from .weld import weld

PULLS = 3e-4, 3e-3
"""Rims are drawn together from up to this far in chains, where that makes the caps smaller."""
ENOUGH = 0.25
"""Caps that are smaller by this than fans alone will do."""
MANY = 1000
"""Edges between faces that run against each other, for fewer of which fans are quick enough; and
edges of rims, for more of which it is estimated if drawing them together is worth the time."""
WORTH = 0.75
"""Of the area of fans alone, what strips may have."""
LOOKED_AT = 50
"""Vertices whose nearest neighbour tells how wide gaps are."""


class Caps(NamedTuple):
    """Closed loops of edges that add up to the boundary, a fan of triangles for each.

    Parameters
    ----------
    vertices : array, shape (n + k, 3)
        The mesh's, then the middles of those k loops that have more than four edges.
    faces : array, shape (t, 3), int32
        Of all fans. With the mesh's own they make a closed surface.
    loop, start : arrays, shapes (e,) and (l + 1,), int64
        As of a `Boundary`.
    apex : array, shape (l,), int64
        The vertex that the triangles of a fan share: of a short loop its first.
    area : float
        Of all triangles.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    loop: NDArray[np.int64]
    start: NDArray[np.int64]
    apex: NDArray[np.int64]
    area: float


def cap_holes(vertices: NDArray[np.float64], faces: NDArray[np.int32], boundary: Boundary) -> Caps:
    """Close a mesh.

    Parameters
    ----------
    vertices : array, shape (n, 3)
        In the unit cube.
    faces : array, shape (m, 3), int32
    boundary : Boundary
        Of these.

    Returns
    -------
    Caps
        The smallest that were found, among several ways to close it.
    """

    def caps_of(way: Callable[[], Boundary]) -> Caps:
        return _capped(vertices, way())

    plain = caps_of(lambda: boundary)
    if len(boundary.loop) == 0:
        return plain
    near, far = (partial(_drawn_together, vertices, boundary, pull) for pull in PULLS)
    best = min(plain, caps_of(near), key=lambda caps: caps.area)
    if best.area < ENOUGH * plain.area:
        return best
    others = []
    if len(boundary.loop) < MANY or _strip_area(vertices, boundary) < WORTH * plain.area:
        others.append(far)
    edges = np.sort(boundary.loop * len(vertices) + boundary.following)
    doubled = np.count_nonzero(edges[1:] == edges[:-1])  # two faces use them in one direction
    if doubled > MANY:
        others.append(partial(_turned_back, vertices, faces))
    return min([best, *in_threads(caps_of, others)], key=lambda caps: caps.area)


def _turned_back(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Boundary:
    """Return loops around each face to be turned round, twice, and those that are left then."""
    turned = inconsistent_faces(vertices, faces)
    left = find_boundary(np.where(turned[:, None], faces[:, ::-1], faces))
    faces = faces[turned]
    faces = np.repeat(faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)], 2, axis=0)
    start = np.concatenate([3 * np.arange(len(faces)), 3 * len(faces) + left.start])
    return Boundary(np.concatenate([faces.ravel(), left.loop]), start)


def _capped(vertices: NDArray[np.float64], loops: Boundary) -> Caps:
    apex, middles, faces = fans(vertices, *loops)
    vertices = np.concatenate([vertices, middles])
    return Caps(vertices, faces, *loops, apex, _area(vertices, faces))


def _drawn_together(vertices: NDArray[np.float64], boundary: Boundary, pull: float) -> Boundary:
    """Return the loops of the strips, and those that are left when they are laid."""
    a, b = boundary.loop, boundary.following
    rim = np.flatnonzero(np.bincount(a))
    _, group = weld(vertices[rim], pull)
    one = np.empty(group.max() + 1, np.int64)
    one[group[::-1]] = rim[::-1]  # any vertex of the group
    drawn = np.arange(len(vertices))
    drawn[rim] = one[group]
    loop, start = _strips(a, b, drawn)

    a, b = drawn[a], drawn[b]
    key, index = np.unique(np.minimum(a, b) * len(vertices) + np.maximum(a, b), return_inverse=True)
    balance = np.bincount(index, np.sign(b - a)).astype(np.int32)
    edges = np.stack([key // len(vertices), key % len(vertices)], axis=1).astype(np.int32)
    left = boundary_of(edges, balance)
    return Boundary(
        np.concatenate([loop, left.loop]), np.concatenate([start, left.start[1:] + start[-1]])
    )


def _strip_area(vertices: NDArray[np.float64], boundary: Boundary) -> float:
    """Estimate the area of strips that close the gaps between rims."""
    a, b = vertices[boundary.loop], vertices[boundary.following]
    gap = _gap(a, len(a) // LOOKED_AT)
    return gap * float(np.linalg.norm(b - a, axis=1).sum())


@lean
def _gap(points, step):
    """Return how far each so-manieth point is from its nearest neighbour, on average."""
    total, count = 0.0, 0
    for i in range(0, len(points), step):
        least = np.inf
        for j in range(len(points)):
            x = points[j, 0] - points[i, 0]
            y = points[j, 1] - points[i, 1]
            z = points[j, 2] - points[i, 2]
            squared = x * x + y * y + z * z
            least = squared if 0 < squared < least else least
        total += np.sqrt(least)
        count += 1
    return total / count


@compiled
def _strips(a, b, drawn):
    loop, start = np.empty(4 * len(a), np.int64), np.empty(len(a) + 1, np.int64)
    size = count = start[0] = 0
    for e in range(len(a)):
        from_a, from_b = drawn[a[e]], drawn[b[e]]
        stays = from_a == a[e] and from_b == b[e]
        if stays or from_a == b[e] or from_b == a[e]:
            continue  # nothing to span
        loop[size], loop[size + 1] = a[e], b[e]
        size += 2
        if from_b != b[e]:
            loop[size] = from_b
            size += 1
        if from_a != a[e] and from_a != from_b:
            loop[size] = from_a
            size += 1
        count += 1
        start[count] = size
    return loop[:size].copy(), start[: count + 1].copy()


@compiled
def fans(vertices, loop, start):
    apex, middles = np.empty(len(start) - 1, np.int64), np.zeros((len(start) - 1, 3))
    faces = np.empty((len(loop), 3), np.int32)
    fans = count = 0
    for k in range(len(start) - 1):
        begin, end = start[k], start[k + 1]
        if end - begin <= 4:
            apex[k] = loop[begin]
        else:
            apex[k] = len(vertices) + fans
            for i in range(begin, end):
                for axis in range(3):
                    middles[fans, axis] += vertices[loop[i], axis] / (end - begin)
            fans += 1
        for i in range(begin, end):
            after = loop[i + 1] if i + 1 < end else loop[begin]
            if apex[k] != loop[i] and apex[k] != after:
                # The chain's edge a -> b must be undone, so its triangle runs b -> a.
                faces[count, 0], faces[count, 1], faces[count, 2] = after, loop[i], apex[k]
                count += 1
    return apex, middles[:fans].copy(), faces[:count].copy()


@compiled
def _area(vertices, faces):
    total = 0.0
    for f in range(len(faces)):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        total += length(cross(between(a, b), between(a, c))) / 2
    return total
