"""Triangle meshes, checked and frozen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import MeshError
from ..runtime.repr import Summarized
from .checks import as_array, check_finite, frozen


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

    if TYPE_CHECKING:  # what is given may be of other types than what is kept

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
        object.__setattr__(self, "vertices", frozen(vertices))
        object.__setattr__(self, "faces", frozen(faces.astype(np.int32)))

    @property
    def _summary(self) -> dict[str, Any]:
        size = " x ".join(f"{side:.3g}" for side in np.ptp(self.bounds, axis=0))
        return {"vertices": len(self.vertices), "triangles": len(self.faces), "size": size}

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of the faces' bounding box, shape (2, 3)."""
        used = self.vertices[np.unique(self.faces)]
        return np.stack([used.min(axis=0), used.max(axis=0)])
