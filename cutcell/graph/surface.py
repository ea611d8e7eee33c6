"""The surface of a mesh, prepared once for algorithm 1 (paper section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..errors import MeshError
from ..geometry.closed_parts import separate_closed_parts
from ..geometry.welded import WeldedMesh
from ..rig import TriangleMesh
from ..runtime.progress import Tell
from .lattice import Lattice
from .orientation.doubled import find_reversed
from .orientation.orient import find_inverted, flipped
from .rays import expected_hits

REVERSE, WALL = 1, 2
"""Faces that are left out: reverse sides of other faces, and walls of voids."""
MAX_LAYERS = 100
"""Faces that a ray through the mesh's cube may cross on average. Characters have 2 at most."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A welded mesh with faces that are oriented outward.

    Parameters
    ----------
    lattice : Lattice
    mesh : WeldedMesh
        Closed parts that touch are separate, and faces that are left out have collapsed.
    part : array, shape (m,), int32
        The closed part that each face belongs to, or -1.
    inverted : array, shape (m,), bool
        Which faces of the mesh were flipped.
    omitted : array, shape (m,), uint8
        Which faces are left out, see `CutCellGraph`.
    """

    lattice: Lattice
    mesh: WeldedMesh
    part: NDArray[np.int32]
    inverted: NDArray[np.bool_]
    omitted: NDArray[np.uint8]

    @property
    def resolution(self) -> int:
        """R."""
        return self.lattice.resolution


def prepare_surface(
    mesh: TriangleMesh,
    resolution: int,
    orient: bool = True,
    fill: bool = True,
    report: Tell = lambda done: None,
) -> Surface:
    """Weld the vertices of a mesh, separate its closed parts and orient its faces.

    With `fill`, walls of voids are left out, and the nearest other vertices stand for theirs.

    Raises
    ------
    ParameterError
        `resolution` is out of its range.
    MeshError
        The mesh is too large or too small, or its faces are repeated hundreds of times.
    """
    lattice, file_faces, welded = Lattice.around(mesh, resolution), mesh.faces, mesh.welded
    _check_layers(welded)
    omitted = np.zeros(len(file_faces), np.uint8)
    inverted = np.zeros(len(file_faces), np.bool_)
    if orient:
        omitted[find_reversed(welded)] = REVERSE
        if omitted.any():
            file_faces = _collapsed(file_faces, omitted == REVERSE)
            welded = replace(welded, faces=welded.index[file_faces])
    welded, part = separate_closed_parts(welded, file_faces)
    if orient:
        inverted, is_wall = find_inverted(welded, report)
        if fill and is_wall.any():
            omitted[is_wall], inverted[is_wall] = WALL, False
            welded = _without_walls(welded, is_wall)
        if inverted.any():
            welded = replace(welded, faces=flipped(welded.faces, inverted))
    return Surface(lattice, welded, part, inverted, omitted)


def _check_layers(mesh: WeldedMesh) -> None:
    """Refuse a mesh whose faces are in too many layers: a small file could take minutes."""
    layers = expected_hits(mesh.points, mesh.faces, 1) / 3
    if layers > MAX_LAYERS:
        raise MeshError(
            f"its {len(mesh.faces):,} faces lie in {layers:,.0f} layers on average, which would "
            f"take minutes. The limit is {MAX_LAYERS}. Remove repeated faces"
        )


def _without_walls(mesh: WeldedMesh, is_wall: NDArray[np.bool_]) -> WeldedMesh:
    """Return a mesh without the vertices of walls; the nearest others stand for them."""
    used = np.unique(mesh.faces[~is_wall])
    node = cKDTree(mesh.points[used]).query(mesh.points)[1].astype(np.int32)
    node[used] = np.arange(len(used))
    faces = node[_collapsed(mesh.faces, is_wall)]
    return WeldedMesh(mesh.points[used], node[mesh.index], faces)


def _collapsed(faces: NDArray[np.int32], which: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return faces, shape (m, 3), some of which, (m,), have all corners in one vertex."""
    return np.where(which[:, None], faces[:, :1], faces)
