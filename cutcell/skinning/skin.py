"""The skin of a mesh: all that is asked of it whatever the bones are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..graph import CutCellGraph
from .elimination import order_of_elimination
from .laplacian import stiffness, vertex_areas, vertex_normals
from .pieces import find_pieces


@dataclass(frozen=True, eq=False)
class Skin:
    """What weights spread over.

    Parameters
    ----------
    points : array, shape (k, 3)
        The places of the mesh, in the unit cube.
    faces : array, shape (m, 3), int32
        Those that welding has not closed up.
    normals, areas : arrays, shapes (k, 3) and (k,)
        See `laplacian`.
    piece : array, shape (k,)
        Of each place, see `find_pieces`.
    stiffness : tuple of arrays
        How it conducts, see `laplacian.stiffness`.
    order : array, shape (k,), int32
        See `order_of_elimination`.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.int32]
    normals: NDArray[np.float64]
    areas: NDArray[np.float64]
    piece: NDArray[np.int32]
    stiffness: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]
    order: NDArray[np.int32]

    @classmethod
    def of(cls, graph: CutCellGraph) -> Skin:
        """Find it on the mesh of a graph."""
        return cls.over(graph.nodes[: graph.first_point], graph.faces)

    @classmethod
    def over(cls, points: NDArray[np.float64], faces: NDArray[np.int32]) -> Skin:
        """Find it on a mesh: points (k, 3) in the unit cube, faces (m, 3)."""
        faces = _whole(faces)
        return cls(points, faces, *_look_at(points, faces))


# A single kernel, so that another thread is asked for Python's lock but once.
@compiled
def _look_at(points, faces):
    normals, areas = vertex_normals(points, faces), vertex_areas(points, faces)
    conducts = stiffness(points, faces)
    order = order_of_elimination(conducts[0], conducts[1])
    return normals, areas, find_pieces(faces, len(points)), conducts, order


def _whole(faces: NDArray[np.int32]) -> NDArray[np.int32]:
    """Drop triangles that welding has closed up."""
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (c != a)]
