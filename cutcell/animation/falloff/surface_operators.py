"""The operators of a mesh's surface that weights are smoothed by, whatever the bones are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ...geometry.laplacian import stiffness, vertex_areas, vertex_normals
from ...geometry.triangles import label_components
from ...graph import CutCellGraph
from ...runtime.compiled import compiled
from .dissection import Dissection, dissect


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

    Attributes
    ----------
    dissection : Dissection
        Order in which equations with such rows are solved.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.int32]
    normals: NDArray[np.float64]
    areas: NDArray[np.float64]
    component: NDArray[np.int32]
    stiffness: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]

    @cached_property
    def dissection(self) -> Dissection:
        """Order in which equations with such rows are solved."""
        return dissect(*self.stiffness[:2])

    @classmethod
    def over(cls, points: NDArray[np.float64], faces: NDArray[np.int32]) -> SurfaceOperators:
        """Compute those of a mesh: points (k, 3) in the unit cube, faces (m, 3)."""
        a, b, c = faces.T
        faces = faces[(a != b) & (b != c) & (c != a)]  # the others were welded to nothing
        normals, areas, rows = _operators(points, faces)
        component = label_components(faces, len(points))
        return cls(points, faces, normals, areas, component, rows)


_computed: WeakKeyDictionary[CutCellGraph, SurfaceOperators] = WeakKeyDictionary()


def surface_of(graph: CutCellGraph) -> SurfaceOperators:
    """Return the operators of a graph's mesh, computed once."""
    if graph not in _computed:
        _computed[graph] = SurfaceOperators.over(graph.nodes[: graph.first_point], graph.faces)
    return _computed[graph]


# One compiled function: each call from another thread has to wait for Python's lock.
@compiled
def _operators(points, faces):
    normals, areas = vertex_normals(points, faces), vertex_areas(points, faces)
    return normals, areas, stiffness(points, faces)
