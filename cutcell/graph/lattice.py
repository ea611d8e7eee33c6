"""The unit cube, the lattice in it, and the maps to it and back (paper section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import MeshError
from ..geometry.vectors import TIE
from ..method import check_resolution
from ..rig import TriangleMesh
from ..rig.checks import MAX_COORDINATE, check_positions


@dataclass(frozen=True, eq=False)
class Lattice:
    """Cell centres (i + 1/2) / R of the unit cube that holds a mesh, centred, longest side 1.

    Parameters
    ----------
    resolution : int
        R, cells along each side of the cube.
    low : array, shape (3,)
        Lowest corner of the mesh's bounding box, file units.
    size : float
        Longest side of the bounding box, file units: one side of the cube.
    offset : array, shape (3,)
        Position of `low` in the cube.
    diagonal : float
        D, the diagonal of the mesh's bounding box in the cube's units.
    """

    resolution: int
    low: NDArray[np.float64]
    size: float
    offset: NDArray[np.float64]
    diagonal: float

    @classmethod
    def around(cls, mesh: TriangleMesh, resolution: int) -> Lattice:
        """Fit the unit cube to the faces of a mesh.

        Raises
        ------
        ParameterError
            `resolution` is not a whole number from 2 to 1024.
        MeshError
            The mesh is too large or too small to compute with.
        """
        resolution = check_resolution(resolution)
        check_positions(mesh.vertices, "vertex", MeshError)
        low, high = mesh.bounds
        size = float((high - low).max())
        if size * MAX_COORDINATE < 1:
            raise MeshError(
                f"the mesh is only {size:.3g} long, too small to compute with (the limit is "
                f"{1 / MAX_COORDINATE:g}); scale the whole character up"
            )
        # Dividing, not multiplying by 1 / size, maps a mesh scaled by a power of two to the
        # very same numbers.
        extent = (high - low) / size
        return cls(resolution, low, size, (1 - extent) / 2, float(np.linalg.norm(extent)))

    def order(self, *points: NDArray[np.float64]) -> NDArray[np.intp]:
        """Sort rows of points (n, 3) in the cube, by the mesh's longest side first."""
        columns = np.concatenate([p[:, self.axes] for p in points], axis=1)
        return np.lexsort(np.rint(columns.T[::-1] / TIE))

    @property
    def axes(self) -> NDArray[np.intp]:
        """The axes by the mesh's size along them, the longest first."""
        return np.argsort(np.rint(self.offset / TIE), kind="stable")

    def to_unit(self, points: ArrayLike) -> NDArray[np.float64]:
        """Bring points (..., 3) from the file's units into the unit cube."""
        return (np.asarray(points, np.float64) - self.low) / self.size + self.offset

    def to_file(self, points: ArrayLike) -> NDArray[np.float64]:
        """Bring points (..., 3) from the unit cube back into the file's units."""
        return (np.asarray(points, np.float64) - self.offset) * self.size + self.low
