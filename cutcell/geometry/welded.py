"""A welded mesh, and what follows from its points and faces: computed once, on first use."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .boundary import Boundary, boundary_of
from .dissection import Dissection, dissect
from .edges import MeshEdges, find_edges
from .laplacian import stiffness, vertex_areas, vertex_normals
from .triangles import areas, label_components


@dataclass(frozen=True, eq=False)
class WeldedMesh:
    """A mesh in the unit cube whose vertices at one place are one.

    Parameters
    ----------
    points : array, shape (k, 3), float64
        Welded vertices.
    index : array, shape (n,), int32
        The welded vertex of each vertex of the file.
    faces : array, shape (m, 3), int32
        All faces of the file. Those with a repeated corner have collapsed.
    """

    points: NDArray[np.float64]
    index: NDArray[np.int32]
    faces: NDArray[np.int32]

    @classmethod
    def of(cls, points: NDArray[np.float64], faces: NDArray[np.int32]) -> WeldedMesh:
        """Return a mesh whose vertices, shape (k, 3), are welded already."""
        return cls(points, np.arange(len(points), dtype=np.int32), faces)

    @cached_property
    def first(self) -> NDArray[np.intp]:
        """The first vertex of the file at each welded vertex, shape (k,)."""
        first = np.empty(len(self.points), np.intp)
        first[self.index[::-1]] = np.arange(len(self.index))[::-1]
        return first

    @cached_property
    def is_whole(self) -> NDArray[np.bool_]:
        """Which faces have not collapsed, shape (m,)."""
        a, b, c = self.faces.T
        return np.asarray((a != b) & (b != c) & (c != a))

    @cached_property
    def edges(self) -> MeshEdges:
        """Edges, with the faces on either side."""
        return find_edges(self.faces)

    @cached_property
    def edge_lengths(self) -> NDArray[np.float64]:
        """The length of each edge, shape (e,)."""
        start, end = self.edges.edges.T
        return np.asarray(np.linalg.norm(self.points[start] - self.points[end], axis=1))

    @cached_property
    def boundary(self) -> Boundary:
        """The boundary chain, as loops."""
        return boundary_of(self.edges.edges, self.edges.incidence)

    @property
    def is_closed(self) -> bool:
        """Whether the faces have no boundary."""
        return not self.edges.incidence.any()

    @cached_property
    def component(self) -> NDArray[np.int32]:
        """The connected component of each welded vertex, shape (k,).

        Components are numbered by the count of their vertices in the file, from the largest.
        """
        label = label_components(self.faces, len(self.points))
        order = np.argsort(-np.bincount(label[self.index]), kind="stable")
        number = np.empty(len(order), np.int32)
        number[order] = np.arange(len(order))
        return number[label]

    @cached_property
    def longest_sides(self) -> NDArray[np.float64]:
        """The longest side of the bounding box of each component, shape (c,)."""
        low = np.full((int(self.component.max()) + 1, 3), np.inf)
        high = -low
        np.minimum.at(low, self.component, self.points)
        np.maximum.at(high, self.component, self.points)
        return np.asarray((high - low).max(axis=1))

    @cached_property
    def face_areas(self) -> NDArray[np.float64]:
        """The area of each face, shape (m,)."""
        return areas(self.points[self.faces])

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """The area around each welded vertex, shape (k,), see `vertex_areas`."""
        return np.asarray(vertex_areas(self.points, self._whole_faces))

    @cached_property
    def normals(self) -> NDArray[np.float64]:
        """The unit normal of each welded vertex, shape (k, 3), see `vertex_normals`."""
        return np.asarray(vertex_normals(self.points, self._whole_faces))

    @cached_property
    def stiffness(self) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
        """Rows of the cotangent Laplacian, see `laplacian.stiffness`."""
        rows: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]
        rows = stiffness(self.points, self._whole_faces)
        return rows

    @cached_property
    def dissection(self) -> Dissection:
        """Order in which equations with such rows are solved."""
        return dissect(*self.stiffness[:2])

    @property
    def _whole_faces(self) -> NDArray[np.int32]:
        return self.faces if self.is_whole.all() else self.faces[self.is_whole]
