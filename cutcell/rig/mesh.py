"""Triangle meshes, checked and frozen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import assign, check_choice
from ..errors import MeshError
from ..geometry.weld import weld
from ..geometry.welded import WeldedMesh
from ..runtime.repr import Summarized
from .checks import MAX_COORDINATE, as_array, check_finite, check_positions, frozen

COUNTS = ("welded", "vertices")


@dataclass(frozen=True, eq=False)
class UnitCube:
    """The maps between a file's units and the unit cube that holds a mesh, centred.

    Parameters
    ----------
    low : array, shape (3,)
        Lowest corner of the mesh's bounding box, file units.
    size : float
        Longest side of the bounding box, file units: one side of the cube.
    offset : array, shape (3,)
        Position of `low` in the cube.
    """

    low: NDArray[np.float64]
    size: float
    offset: NDArray[np.float64]

    @property
    def diagonal(self) -> float:
        """D, the diagonal of the mesh's bounding box in the cube's units."""
        return float(np.linalg.norm(1 - 2 * self.offset))

    def to_unit(self, points: ArrayLike) -> NDArray[np.float64]:
        """Bring points (..., 3) from the file's units into the unit cube."""
        # Dividing, not multiplying by 1 / size, maps a mesh scaled by a power of two to the
        # very same numbers.
        return (np.asarray(points, np.float64) - self.low) / self.size + self.offset

    def to_file(self, points: ArrayLike) -> NDArray[np.float64]:
        """Bring points (..., 3) from the unit cube back into the file's units."""
        return (np.asarray(points, np.float64) - self.offset) * self.size + self.low


@dataclass(frozen=True, eq=False, repr=False)
class TriangleMesh(Summarized):
    """Triangles in space; closed or open, clean or a soup.

    Parameters
    ----------
    vertices : array_like, shape (n, 3), float64
        Rest positions in the file's units.
    faces : array_like, shape (m, 3), int32
        Vertex indices, counter-clockwise seen from outside.

    Raises
    ------
    MeshError
        No vertices or faces, a coordinate that is not finite, an index out of range, or
        a mesh without extent.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    if TYPE_CHECKING:  # arguments may have other types than the fields

        def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None: ...

    def __post_init__(self) -> None:
        vertices = as_array(self.vertices, np.float64, (None, 3), "vertices", MeshError)
        faces = as_array(self.faces, np.int64, (None, 3), "faces", MeshError)
        if len(faces) == 0:
            raise MeshError("the mesh has no faces; it needs at least one triangle")
        check_finite(vertices, "vertex", MeshError)
        bad = np.flatnonzero(((faces < 0) | (faces >= len(vertices))).any(axis=1))
        if len(bad):
            raise MeshError(
                f"face {bad[0]} uses the vertices {faces[bad[0]].tolist()}, but the mesh has "
                f"only {len(vertices)} (numbered from 0); faces out of range: {len(bad)}"
            )
        assign(self, vertices=frozen(vertices), faces=frozen(faces.astype(np.int32)))
        if (self.bounds[0] == self.bounds[1]).all():
            raise MeshError("all faces of the mesh lie in one point; it has no extent")

    @property
    def _summary(self) -> dict[str, Any]:
        size = " x ".join(f"{side:.3g}" for side in np.ptp(self.bounds, axis=0))
        return {"vertices": len(self.vertices), "triangles": len(self.faces), "size": size}

    @cached_property
    def used(self) -> NDArray[np.intp]:
        """The vertices that faces use, ascending."""
        is_used = np.zeros(len(self.vertices), np.bool_)
        is_used[self.faces] = True
        return np.flatnonzero(is_used)

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of the faces' bounding box, shape (2, 3)."""
        used = self.vertices[self.used]
        return np.stack([used.min(axis=0), used.max(axis=0)])

    @cached_property
    def cube(self) -> UnitCube:
        """The unit cube around the faces.

        Raises
        ------
        MeshError
            The mesh is too large or too small to compute with.
        """
        check_positions(self.vertices, "vertex", MeshError)
        low, high = self.bounds
        size = float((high - low).max())
        if size * MAX_COORDINATE < 1:
            raise MeshError(
                f"the mesh is only {size:.3g} long, too small to compute with (the limit is "
                f"{1 / MAX_COORDINATE:g}); scale the whole character up"
            )
        return UnitCube(low, size, (1 - (high - low) / size) / 2)

    @cached_property
    def welded(self) -> WeldedMesh:
        """The mesh in the unit cube, with vertices at one place merged (`geometry.weld`).

        Raises
        ------
        MeshError
            The mesh is too large or too small to compute with.
        """
        points, index = weld(self.cube.to_unit(self.vertices))
        return WeldedMesh(points, index, index[self.faces])


def vertex_shares(mesh: TriangleMesh, count: str = "welded") -> NDArray[np.float64]:
    """Return each vertex's share of a mean over the mesh.

    Exporters split a vertex at every texture seam. Counted as they are in the file, seams
    would weigh two and three times as much as the skin between them.

    Parameters
    ----------
    mesh : TriangleMesh
    count : {"welded", "vertices"}
        "welded": every welded vertex counts once, the file's vertices share it evenly.
        "vertices": every vertex of the file counts the same. Vertices that no face uses count
        nothing.

    Returns
    -------
    array, shape (n,), float64
        Sums to one.

    Raises
    ------
    ParameterError
        An unknown `count`.
    """
    check_choice("count", count, COUNTS)
    share = np.zeros(len(mesh.vertices))
    share[mesh.used] = 1.0
    if count == "welded":
        welded = mesh.welded.index[mesh.used]
        share[mesh.used] = 1.0 / np.bincount(welded)[welded]
    return share / share.sum()
