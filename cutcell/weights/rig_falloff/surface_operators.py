"""The operators of a mesh's surface that weights are smoothed by, whatever the bones are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.laplacian import stiffness, vertex_areas, vertex_normals
from ...graph import CutCellGraph
from ...runtime.compiled import compiled
from .components import label_components
from .ldl import fill_reducing_ordering

MANY = 50_000
"""Welded vertices up to which equations are solved by factors of their matrix, which for few takes
the least time and is exact. The time for factors grows faster than the mesh: from about here on
multigrid takes less."""


@dataclass(frozen=True, eq=False)
class SurfaceOperators:
    """The cotangent Laplacian of a welded mesh, and what goes with it.

    Parameters
    ----------
    points : array, shape (k, 3)
        The welded vertices, in the unit cube.
    faces : array, shape (m, 3), int32
        Triangles with three different corners.
    normals, areas : arrays, shapes (k, 3) and (k,)
        Per welded vertex, see `laplacian`.
    component : array, shape (k,)
        The connected component of each welded vertex, see `label_components`.
    stiffness : tuple of arrays
        Rows of the Laplacian, see `laplacian.stiffness`.
    order : array, shape (k,), int32, or None
        See `fill_reducing_ordering`; None for more than `MANY` welded vertices.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.int32]
    normals: NDArray[np.float64]
    areas: NDArray[np.float64]
    component: NDArray[np.int32]
    stiffness: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]
    order: NDArray[np.int32] | None

    @classmethod
    def of(cls, graph: CutCellGraph) -> SurfaceOperators:
        """Compute those of a graph's mesh."""
        return cls.over(graph.nodes[: graph.first_point], graph.faces)

    @classmethod
    def over(cls, points: NDArray[np.float64], faces: NDArray[np.int32]) -> SurfaceOperators:
        """Compute those of a mesh: points (k, 3) in the unit cube, faces (m, 3)."""
        a, b, c = faces.T
        faces = faces[(a != b) & (b != c) & (c != a)]  # the others were welded to nothing
        has_order = len(points) <= MANY
        normals, areas, component, rows, order = _operators(points, faces, has_order)
        known = points, faces, normals, areas, component, rows
        return cls(*known, order if has_order else None)


# One compiled function: each call from another thread has to wait for Python's lock.
@compiled
def _operators(points, faces, has_order):
    normals, areas = vertex_normals(points, faces), vertex_areas(points, faces)
    rows = stiffness(points, faces)
    order = fill_reducing_ordering(rows[0], rows[1]) if has_order else np.empty(0, np.int32)
    return normals, areas, label_components(faces, len(points)), rows, order
