"""The surface of a mesh, prepared once for algorithm 1 (paper section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..errors import MeshError
from ..geometry.closed_parts import separate_closed_parts
from ..geometry.edges import find_edges
from ..geometry.weld import weld
from ..rig import TriangleMesh
from ..runtime.progress import Tell
from .lattice import Lattice
from .orientation.doubled import find_reversed
from .orientation.orient import find_inverted, flipped
from .rays import expected_hits
from .winding.boundary import Boundary, boundary_of

REVERSE, WALL = 1, 2
"""Faces that are left out: reverse sides of other faces, and walls of voids."""
MAX_LAYERS = 100
"""Faces that a ray through the mesh's cube may cross on average. Characters have 2 at most."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh in the unit cube, welded, with faces that are oriented outward.

    Parameters
    ----------
    lattice : Lattice
    vertices : array, shape (n, 3), float64
        Welded vertices.
    vertex_node : array, shape (v,), int32
        The welded vertex of each vertex of the mesh.
    faces : array, shape (m, 3), int32
    part : array, shape (m,), int32
        The closed part that each face belongs to, or -1.
    edges : array, shape (e, 2), int32
    boundary : Boundary
    inverted : array, shape (m,), bool
        Which faces of the mesh were flipped.
    omitted : array, shape (m,), uint8
        Which faces are left out, see `CutCellGraph`.
    """

    lattice: Lattice
    vertices: NDArray[np.float64]
    vertex_node: NDArray[np.int32]
    faces: NDArray[np.int32]
    part: NDArray[np.int32]
    edges: NDArray[np.int32]
    boundary: Boundary
    inverted: NDArray[np.bool_]
    omitted: NDArray[np.uint8]

    @property
    def resolution(self) -> int:
        """R."""
        return self.lattice.resolution

    @property
    def is_closed(self) -> bool:
        """Whether the faces have no boundary."""
        return len(self.boundary.loop) == 0


def prepare_surface(
    mesh: TriangleMesh,
    resolution: int,
    orient: bool = True,
    fill: bool = True,
    report: Tell = lambda done: None,
) -> Surface:
    """Bring a mesh into the unit cube, weld its vertices and orient its faces.

    With `fill`, walls of voids are left out, and the nearest other vertices stand for theirs.

    Raises
    ------
    ParameterError
        `resolution` is out of its range.
    MeshError
        The mesh is too large or too small, or its faces are repeated hundreds of times.
    """
    lattice = Lattice.around(mesh, resolution)
    vertices, faces = lattice.to_unit(mesh.vertices), mesh.faces
    _check_layers(vertices, faces)
    vertices, index = weld(vertices)
    omitted, inverted = np.zeros(len(faces), np.uint8), np.zeros(len(faces), np.bool_)
    mesh_edges = find_edges(index[faces])
    if orient:
        omitted[find_reversed(vertices, index[faces], mesh_edges.partner)] = REVERSE
        if omitted.any():
            faces = np.where(omitted[:, None], faces[:, :1], faces)  # collapsed
            mesh_edges = find_edges(index[faces])
    vertices, split, part = separate_closed_parts(vertices, index, faces, mesh_edges.partner)
    if split is not index:
        mesh_edges = find_edges(split[faces])
    index, faces = split, split[faces]
    if orient:
        inverted, is_wall = find_inverted(vertices, faces, mesh_edges.partner, report)
        if fill and is_wall.any():
            omitted[is_wall], inverted[is_wall] = WALL, False
            used = np.unique(faces[~is_wall])
            faces = np.where(is_wall[:, None], faces[:, :1], faces)
            node = cKDTree(vertices[used]).query(vertices)[1].astype(np.int32)
            node[used] = np.arange(len(used))
            vertices, index, faces = vertices[used], node[index], node[faces]
        faces = flipped(faces, inverted)
        if (inverted | (omitted == WALL)).any():
            mesh_edges = find_edges(faces)
    boundary = boundary_of(mesh_edges.edges, mesh_edges.incidence)
    return Surface(
        lattice, vertices, index, faces, part, mesh_edges.edges, boundary, inverted, omitted
    )


def _check_layers(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> None:
    """Refuse a mesh whose faces are in too many layers: a small file could take minutes."""
    layers = expected_hits(vertices, faces, 1) / 3
    if layers > MAX_LAYERS:
        raise MeshError(
            f"its {len(faces):,} faces lie in {layers:,.0f} layers on average, which would take "
            f"minutes. The limit is {MAX_LAYERS}. Remove repeated faces"
        )
