"""Fans that close the holes of a mesh, so that counting crossings is nearly enough.

With every hole capped, the signed count of crossings is a whole number: the winding
number of the closed surface. The mesh's own number differs from it by the solid angle of
the caps, at most area / (4 pi distance^2) of each, and that is seldom enough to matter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .winding import Boundary


@dataclass(frozen=True, eq=False)
class Caps:
    """One fan of triangles for each component of a boundary.

    Parameters
    ----------
    vertices : array, shape (n + k, 3)
        The mesh's vertices, then the apex of each of the k fans.
    faces : array, shape (e, 3), int32
        Ordered by fan.
    start : array, shape (k + 1,), int64
        The triangles of fan i are those from start[i] to start[i + 1].
    count : array, shape (e,), int64
        How often each triangle must be laid; negative when turned round.
    centre : array, shape (k, 3)
    radius : array, shape (k,)
        Sphere that holds the fan.
    area : array, shape (k,)
        Of the fan, triangles laid twice counted twice.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    start: NDArray[np.int64]
    count: NDArray[np.int64]
    centre: NDArray[np.float64]
    radius: NDArray[np.float64]
    area: NDArray[np.float64]


def cap_holes(vertices: NDArray[np.float64], boundary: Boundary) -> Caps:
    """Close each component of a boundary by a fan around the mean of its edges' ends."""
    order = np.argsort(boundary.component, kind="stable")
    edges, component = boundary.edges[order], boundary.component[order]
    count = boundary.count[order]
    size = int(component.max()) + 1 if len(edges) else 0
    ends = vertices[edges]
    uses = np.bincount(component, minlength=size)
    centre = np.stack(
        [np.bincount(component, ends[:, :, k].sum(axis=1), size) / (2 * uses) for k in range(3)],
        axis=1,
    )
    reach = np.linalg.norm(ends - centre[component][:, None], axis=2).max(axis=1)
    radius = np.zeros(size)
    np.maximum.at(radius, component, reach)
    # The chain's edge a -> b must be undone, so its triangle runs b -> a.
    faces = np.stack([edges[:, 1], edges[:, 0], len(vertices) + component], axis=1)
    apex = centre[component]
    cross = np.cross(ends[:, 0] - apex, ends[:, 1] - apex)
    each = np.abs(count) * np.linalg.norm(cross, axis=1) / 2
    area = np.bincount(component, each, size).astype(np.float64)
    return Caps(
        np.concatenate([vertices, centre]),
        faces.astype(np.int32),
        np.searchsorted(component, np.arange(size + 1)),
        count.astype(np.int64),
        centre,
        radius,
        area,
    )
