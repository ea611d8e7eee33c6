"""The unit cube, the lattice in it, and the maps to it and back (paper section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.vectors import TIE
from ..method import check_resolution
from ..rig import TriangleMesh
from ..rig.mesh import UnitCube


@dataclass(frozen=True, eq=False)
class Lattice(UnitCube):
    """Cell centres (i + 1/2) / R of the unit cube that holds a mesh, centred, longest side 1.

    Parameters
    ----------
    low, size, offset
        See `UnitCube`.
    resolution : int
        R, cells along each side of the cube.
    """

    resolution: int

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
        resolution, cube = check_resolution(resolution), mesh.cube
        return cls(cube.low, cube.size, cube.offset, resolution)

    def order(self, *points: NDArray[np.float64]) -> NDArray[np.intp]:
        """Sort rows of points (n, 3) in the cube, by the mesh's longest side first."""
        columns = np.concatenate([p[:, self.axes] for p in points], axis=1)
        return np.lexsort(np.rint(columns.T[::-1] / TIE))

    @property
    def axes(self) -> NDArray[np.intp]:
        """The axes by the mesh's size along them, the longest first."""
        return np.argsort(np.rint(self.offset / TIE), kind="stable")
