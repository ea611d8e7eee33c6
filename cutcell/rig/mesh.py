"""Triangle meshes, checked and frozen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import assign, check_choice
from ..errors import MeshError
from ..geometry.weld import WELD_TOLERANCE, weld
from ..runtime.repr import Summarized
from .checks import as_array, check_finite, frozen

COUNTS = ("welded", "vertices")


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
        used = vertices[np.unique(faces)]
        if (used == used[0]).all():
            raise MeshError("all faces of the mesh lie in one point; it has no extent")
        assign(self, vertices=frozen(vertices), faces=frozen(faces.astype(np.int32)))

    @property
    def _summary(self) -> dict[str, Any]:
        size = " x ".join(f"{side:.3g}" for side in np.ptp(self.bounds, axis=0))
        return {"vertices": len(self.vertices), "triangles": len(self.faces), "size": size}

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of the faces' bounding box, shape (2, 3)."""
        used = self.vertices[np.unique(self.faces)]
        return np.stack([used.min(axis=0), used.max(axis=0)])


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
    used = np.unique(mesh.faces)
    share[used] = 1.0
    if count == "welded":
        low, high = mesh.bounds
        welded = weld(mesh.vertices[used], WELD_TOLERANCE * float((high - low).max()))[1]
        share[used] = 1.0 / np.bincount(welded)[welded]
    return share / share.sum()
