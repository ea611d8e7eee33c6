"""Faces that are inside out: which side of a surface is the outer one.

Connected faces are first oriented consistently (`patches.py`). Then it remains to decide which side
of each patch is the outer one. A patch that encloses a volume (closed, or with small holes) should
enclose a positive one. If the volume is negative, rays decide whether the outside sees its back
(`exposure.py`). An inverted arm is flipped; a cavity in a body, which is invisible, is not, and
neither is a sheet, which is visible from both sides and encloses nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.edges import find_edges
from ...geometry.weld import weld
from ...rig import TriangleMesh
from ...runtime.progress import Tell
from ..lattice import Lattice
from ..winding.boundary import boundary_of
from ..winding.treecode.caps import cap_holes
from .exposure import exposure
from .patches import find_patches, measure_faces

OPEN_PATCH = 0.5
"""A patch is a sheet, which encloses nothing, if its holes have this share of its own area."""
FLAT_VOLUME = 1e-6
"""Volumes below this, relative to area^(3/2), count as zero. For a sphere the ratio is 0.09."""
MIN_ESCAPING = 0.02
"""The least share of rays that escape from a side that is seen from outside."""
CLEARLY_OUTER = 3.0
"""The outer side must see the outside by this factor more than the other."""
MAX_ESCAPING = 0.05
"""The wall of a void sees the outside by less than this share of rays, through leaks."""
HOLLOW = 0.1
"""A body is hollow if its voids have this part of its volume; a closed mouth has 0.001."""
MOSTLY = 0.75
"""A mesh is inverted as a whole if this share of the decidable area is."""


def inverted_faces(mesh: TriangleMesh) -> NDArray[np.bool_]:
    """Find the faces of a mesh that are inside out.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed or open, with any number of components; equal vertices are welded first.

    Returns
    -------
    array, shape (m,), bool
        Faces to flip. Where the outer side is undecidable, as on a sheet seen from both sides,
        faces remain unchanged.

    References
    ----------
    Takayama, Jacobson, Kavan & Sorkine-Hornung, "A simple method for correcting facet
    orientations in polygon meshes based on ray casting", 2014.
    """
    vertices, index = weld(Lattice.around(mesh, 2).to_unit(mesh.vertices))
    faces = index[mesh.faces]
    return find_inverted(vertices, faces, find_edges(faces).partner)[0]


def find_inverted(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
    report: Tell = lambda done: None,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Find the welded faces that are inside out, and those around the voids of a hollow body.

    Shapes: vertices (n, 3), faces (m, 3), partner (3 m,); returns (m,) twice.
    """
    a, b, c = faces.T
    proper = (a != b) & (b != c) & (c != a)
    if proper.all():
        return _find_inverted(vertices, faces, partner, report)
    result = np.zeros((2, len(faces)), np.bool_)
    if proper.any():
        faces = faces[proper]
        result[:, proper] = _find_inverted(vertices, faces, find_edges(faces).partner, report)
    return result[0], result[1]


def _find_inverted(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
    report: Tell,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    areas, volumes = measure_faces(vertices, faces)
    flips, patch, rims, of_rim = find_patches(vertices, faces, partner, areas)
    faces, volumes = flipped(faces, flips), np.where(flips, -volumes, volumes)
    area = np.bincount(patch, areas)
    holes, missing = _cap(vertices, rims, of_rim, len(area))
    is_sheet = holes >= OPEN_PATCH * area
    volume = np.bincount(patch, volumes) + missing
    doubtful = ~is_sheet & (volume < -FLAT_VOLUME * area**1.5)
    if area[is_sheet].sum() > area.sum() / 2:
        doubtful |= is_sheet  # in a soup nothing else decides
    if not doubtful.any():
        return flips, np.zeros_like(flips)
    front, back = exposure(vertices, faces, patch, doubtful, report)
    wrong = (back >= MIN_ESCAPING) & (back >= CLEARLY_OUTER * front)
    right = (front >= MIN_ESCAPING) & (front >= CLEARLY_OUTER * back) | ~(doubtful | is_sheet)
    if wrong.any() and area[wrong].sum() >= MOSTLY * area[wrong | right].sum():
        wrong = ~right  # undecidable patches were inverted with the rest
    is_void = doubtful & ~is_sheet & ~wrong & (np.maximum(front, back) < MAX_ESCAPING)
    is_void &= -volume[is_void].sum() >= HOLLOW * np.abs(volume[~is_void & ~is_sheet]).sum()
    return flips ^ wrong[patch], is_void[patch]


def _cap(
    vertices: NDArray[np.float64],
    rims: NDArray[np.int32],
    of_rim: NDArray[np.int32],
    count: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cap the holes of each patch; return the area of the caps, and their signed volume."""
    if len(rims) == 0:
        return np.zeros(count), np.zeros(count)
    # Patches may share vertices, but not holes.
    key, ends = np.unique(of_rim[:, None] * np.int64(len(vertices)) + rims, return_inverse=True)
    a, b = ends.reshape(-1, 2).T
    side, index = np.unique(np.minimum(a, b) * len(key) + np.maximum(a, b), return_inverse=True)
    incidence = np.bincount(index, np.sign(b - a)).astype(np.int32)
    edges = np.stack(np.divmod(side, len(key)), axis=1).astype(np.int32)
    caps = cap_holes(vertices[key % len(vertices)], boundary_of(edges, incidence))
    areas, volumes = measure_faces(caps.vertices, caps.faces)
    corner = np.where(caps.faces < len(key), caps.faces, 0).max(axis=1)
    of_cap = key[corner] // len(vertices)
    holes, missing = (np.bincount(of_cap, x, count).astype(float) for x in (areas, volumes))
    return holes, missing


def flipped(faces: NDArray[np.int32], which: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return faces, shape (m, 3), with some of them, (m,), flipped."""
    return np.where(which[:, None], faces[:, [0, 2, 1]], faces) if which.any() else faces
