"""Faces of a mesh that are turned inside out, and what the graph takes as their outside.

Faces that hang together are made to run alike (`patches.py`). What is left to decide is which
side of each patch is the outer one. A patch that encloses a volume (closed, or with small holes)
should enclose a positive one. If it does not, rays tell whether its back is what is seen from
outside (`exposure.py`). So an inverted arm is turned; a cavity in a body, which nobody sees, is
not; nor is a sheet that is seen from both sides, and has no inside to be found.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..progress import Tell
from ..rig import TriangleMesh
from .boundary import boundary_of
from .caps import fans
from .exposure import exposure
from .lattice import Lattice
from .mesh_edges import find_edges
from .patches import find_patches, measure_faces
from .weld import weld

OPEN = 0.5
"""A patch whose holes have this much of its own area is a sheet: it encloses nothing."""
FLAT = 1e-6
"""Times area to the power of 3/2: a smaller volume is none. A sphere encloses 0.09 times it."""
SEEN = 0.02
"""Of the rays from a side that is seen from outside, what share gets away at least."""
CLEARLY = 3.0
"""How many times more of the outside one side must see than the other, to be the outer one."""
MOSTLY = 0.75
"""A mesh is inverted as a whole if this much of the area that can be judged is."""


def inverted_faces(mesh: TriangleMesh) -> NDArray[np.bool_]:
    """Tell which faces of a mesh are turned inside out.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed or open, with any number of components; equal vertices are welded first.

    Returns
    -------
    array, shape (m,), bool
        Faces to turn round. Where nothing tells which side is the outer one, as on a sheet
        seen from both sides, faces stay as the file has them.

    References
    ----------
    Takayama, Jacobson, Kavan & Sorkine-Hornung, "A simple method for correcting facet
    orientations in polygon meshes based on ray casting", 2014.
    """
    vertices, index = weld(Lattice.around(mesh, 2).to_unit(mesh.vertices))
    faces = index[mesh.faces]
    return find_inverted(vertices, faces, find_edges(faces).partner)


def oriented(mesh: TriangleMesh) -> TriangleMesh:
    """Return a mesh with its inverted faces turned round; the mesh itself if there are none."""
    inverted = inverted_faces(mesh)
    if not inverted.any():
        return mesh
    return TriangleMesh(mesh.vertices, flipped(mesh.faces, inverted))


def find_inverted(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
    tell: Tell = lambda done: None,
) -> NDArray[np.bool_]:
    """Tell which welded faces are turned inside out.

    Parameters
    ----------
    vertices : array, shape (n, 3)
        In the unit cube.
    faces : array, shape (m, 3), int32
    partner : array, shape (3 m,), int32
        See `mesh_edges.MeshEdges`.
    tell : callable
        See `progress.Tell`.

    Returns
    -------
    array, shape (m,), bool
    """
    a, b, c = faces.T
    proper = (a != b) & (b != c) & (c != a)
    if proper.all():
        return _find_inverted(vertices, faces, partner, tell)
    inverted = np.zeros(len(faces), np.bool_)
    if proper.any():
        faces = faces[proper]
        inverted[proper] = _find_inverted(vertices, faces, find_edges(faces).partner, tell)
    return inverted


def _find_inverted(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
    tell: Tell,
) -> NDArray[np.bool_]:
    areas, volumes = measure_faces(vertices, faces)
    turned, patch, rims, of_rim = find_patches(vertices, faces, partner, areas)
    faces, volumes = flipped(faces, turned), np.where(turned, -volumes, volumes)
    area, volume = np.bincount(patch, areas), np.bincount(patch, volumes)
    holes, missing = _cap(vertices, rims, of_rim, len(area))
    is_sheet = holes >= OPEN * area
    doubtful = ~is_sheet & (volume + missing < -FLAT * area**1.5)
    if area[is_sheet].sum() > area.sum() / 2:
        doubtful |= is_sheet  # in a soup nothing else tells
    if not doubtful.any():
        return turned
    front, back = exposure(vertices, faces, patch, doubtful, tell)
    wrong = (back >= SEEN) & (back >= CLEARLY * front)
    right = (front >= SEEN) & (front >= CLEARLY * back) | ~(doubtful | is_sheet)
    if wrong.any() and area[wrong].sum() >= MOSTLY * area[wrong | right].sum():
        wrong = ~right  # what cannot be told was inverted with the rest
    return turned ^ wrong[patch]


def _cap(
    vertices: NDArray[np.float64],
    rims: NDArray[np.int32],
    of_rim: NDArray[np.int32],
    count: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Close the holes of each patch; return the area of its caps, and the volume before them."""
    if len(rims) == 0:
        return np.zeros(count), np.zeros(count)
    # Two patches may share vertices, but no holes.
    key, ends = np.unique(of_rim[:, None] * np.int64(len(vertices)) + rims, return_inverse=True)
    a, b = ends.reshape(-1, 2).T
    side, index = np.unique(np.minimum(a, b) * len(key) + np.maximum(a, b), return_inverse=True)
    balance = np.bincount(index, np.sign(b - a)).astype(np.int32)
    edges = np.stack(np.divmod(side, len(key)), axis=1).astype(np.int32)
    points = vertices[key % len(vertices)]
    _, middles, caps = fans(points, *boundary_of(edges, balance))
    areas, volumes = measure_faces(np.concatenate([points, middles]), caps)
    of_cap = key[np.where(caps < len(key), caps, 0).max(axis=1)] // len(vertices)
    lids, missing = (np.bincount(of_cap, x, count).astype(float) for x in (areas, volumes))
    return lids, missing


def flipped(faces: NDArray[np.int32], which: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return faces, shape (m, 3), of which some, (m,), are turned round."""
    return np.where(which[:, None], faces[:, [0, 2, 1]], faces) if which.any() else faces
