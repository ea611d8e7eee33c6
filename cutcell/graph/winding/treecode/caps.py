"""Caps that close the holes of a mesh, so that its winding number is nearly a count of crossings.

With every hole capped, the signed count of crossings is a whole number: the winding number of the
closed surface. The mesh's own number is less by that of the caps, see `cells.py`. Any caps will do;
small ones leave fewer cells ambiguous.

Each loop of the boundary chain gets a fan of triangles around its middle. That is large where long
rims run along each other, as those of skin and clothes do: there, strips across the narrow gap
between them are smaller. To find them, rim vertices near each other are merged into one. Each rim
edge a -> b gets a strip a, b, b', a' to its merged ends. The merged edges of rims that fit together
cancel, and only loops of those that are left get fans.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....geometry.triangles import areas
from ....geometry.weld import weld
from ..boundary import Boundary, Caps, boundary_of

GAP = 3e-3
"""Rim vertices this near each other are merged, also in chains."""


def smallest_caps(vertices: NDArray[np.float64], boundary: Boundary) -> Caps:
    """Close a mesh in the unit cube by fans or, if their area is smaller, strips between rims."""
    caps = cap_holes(vertices, boundary)
    if len(boundary.loop) == 0:
        return caps
    return min(caps, cap_holes(vertices, _strips(vertices, boundary)), key=_area)


def cap_holes(vertices: NDArray[np.float64], boundary: Boundary) -> Caps:
    """Close a mesh of vertices (n, 3) that has this boundary by a fan for each of its loops."""
    loop, start = boundary
    size = np.diff(start)
    is_large = size > 4
    apex = np.where(is_large, len(vertices) - 1 + np.cumsum(is_large), loop[start[:-1]])
    sums = np.add.reduceat(vertices[loop], start[:-1]) if len(loop) else np.empty((0, 3))
    middles = (sums / size[:, None])[is_large]
    # Against the direction of the boundary: the edge must cancel.
    faces = np.stack([boundary.following, loop, np.repeat(apex, size)], axis=1)
    faces = faces[(faces[:, 2] != faces[:, 0]) & (faces[:, 2] != faces[:, 1])].astype(np.int32)
    return Caps(np.concatenate([vertices, middles]), faces, loop, start, apex)


def _strips(vertices: NDArray[np.float64], boundary: Boundary) -> Boundary:
    """Return loops that sum to the boundary: around strips, and of the merged edges left."""
    a, b = boundary.loop, boundary.following
    rim = np.unique(a)
    _, group = weld(vertices[rim], GAP)
    first = np.empty(group.max() + 1, np.int64)
    first[group[::-1]] = rim[::-1]  # any vertex of the group
    merged = np.arange(len(vertices))
    merged[rim] = first[group]
    to_a, to_b = merged[a], merged[b]

    corners = np.stack([a, b, to_b, to_a], axis=1)
    moved_a, moved_b = to_a != a, to_b != b
    is_corner = np.stack(
        [moved_a | moved_b, moved_a | moved_b, moved_b, moved_a & (to_a != to_b)], axis=1
    )
    is_corner[(to_a == b) | (to_b == a)] = False  # nothing to span
    size = is_corner.sum(axis=1)
    start = np.concatenate([[0], np.cumsum(size[size > 0])])

    side = np.minimum(to_a, to_b) * len(vertices) + np.maximum(to_a, to_b)
    key, index = np.unique(side, return_inverse=True)
    incidence = np.bincount(index, np.sign(to_b - to_a)).astype(np.int32)
    edges = np.stack(np.divmod(key, len(vertices)), axis=1).astype(np.int32)
    left = boundary_of(edges, incidence)
    start = np.concatenate([start, start[-1] + left.start[1:]])
    loop = np.concatenate([corners[is_corner], left.loop])
    return Boundary(loop, start)


def _area(caps: Caps) -> float:
    return float(areas(caps.vertices[caps.faces]).sum())
