"""Difference of weights between a vertex and its mirror image, over the whole body."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cutcell.editing.symmetry import (
    MIN_MIRRORED,
    Mirror,
    find_mirror,
    mesh_diagonal,
    reflected,
)
from cutcell.errors import MeshError
from cutcell.rig import Rig, TriangleMesh
from cutcell.runtime.progress import Progress, silent

from ..compute.mirror import joint_mirror
from .closest import closest_on_triangle

NEAR = 0.02
"""Bounding-box diagonals: skin that is farther from the mirrored surface has no mirror image."""
CANDIDATES = 12
"""Faces among which the closest one is looked for, those with the nearest centres."""
BLOCK = 1 << 14
"""Vertices that are compared at a time."""


@dataclass(frozen=True, eq=False)
class MirrorImage:
    """The mirror image of each vertex as a mean of vertices.

    Parameters
    ----------
    mirror : Mirror
    vertices : array, shape (n, 3), int32
        The corners of the face that is closest to the mirror image of each vertex.
    shares : array, shape (n, 3), float64
        Their shares of the mean; zero in all where a vertex has no mirror image.
    """

    mirror: Mirror
    vertices: NDArray[np.int32]
    shares: NDArray[np.float64]


def mirror_image(rig: Rig, progress: Progress = silent) -> MirrorImage:
    """Find the mirror image of each vertex and joint.

    Raises
    ------
    MeshError, SkeletonError
        The character is not mirrored.
    """
    progress("symmetry", 0.0)
    try:
        mirror = find_mirror(rig)
    except MeshError:  # only the shape may be mirrored, not each vertex
        mirror = joint_mirror(rig)
    vertices, shares = _images(rig.mesh, mirror, mesh_diagonal(rig), progress)
    part = float(shares[rig.mesh.used].any(axis=1).mean())
    if part < MIN_MIRRORED:
        raise MeshError(
            f"{rig.name} is not mirrored across x, y or z: only {part:.0%} of its vertices have a "
            "mirror image"
        )
    return MirrorImage(mirror, vertices, shares)


def asymmetry(
    weights: NDArray[np.float64], image: MirrorImage, progress: Progress = silent
) -> NDArray[np.float64]:
    """Return the part of each vertex's weight that its mirror image gives to other joints.

    Parameters
    ----------
    weights : array, shape (n, j)
    image : MirrorImage
    progress : callable

    Returns
    -------
    array, shape (n,), float64
        0 for mirrored weights to 1; nan where a vertex has no mirror image. A joint without a
        partner is its own.
    """
    swap = image.mirror.swap
    result = np.full(len(weights), np.nan)
    for first in range(0, len(weights), BLOCK):
        progress("symmetry", first / len(weights))
        part = slice(first, first + BLOCK)
        rows = np.einsum("nk,nkj->nj", image.shares[part], weights[image.vertices[part]])
        gap = np.abs(weights[part] - rows[:, swap]).sum(axis=1) / 2
        result[part] = np.where(image.shares[part].any(axis=1), gap, np.nan)
    return result


def _images(
    mesh: TriangleMesh, mirror: Mirror, diagonal: float, progress: Progress
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Return the corners (n, 3) of the faces closest to mirror images, and their shares (n, 3)."""
    points, faces = mesh.vertices, mesh.faces
    images = reflected(points, mirror.axis, mirror.position)
    count = min(CANDIDATES, len(faces))
    near = cKDTree(points[faces].mean(axis=1)).query(images, k=count)[1].reshape(len(points), -1)
    vertices = np.zeros((len(points), 3), np.int32)
    shares = np.zeros((len(points), 3))
    for first in range(0, len(points), BLOCK):
        progress("symmetry", first / len(points))
        part = slice(first, first + BLOCK)
        corners = faces[near[part]]
        gap, share = closest_on_triangle(images[part, None], points[corners])
        best = (np.arange(len(gap)), gap.argmin(axis=1))
        vertices[part] = corners[best]
        shares[part] = np.where(gap[best][:, None] <= NEAR * diagonal, share[best], 0.0)
    paired = np.flatnonzero(mirror.vertex >= 0) if len(mirror.vertex) else np.zeros(0, np.intp)
    vertices[paired] = mirror.vertex[paired, None]
    shares[paired] = [1.0, 0.0, 0.0]
    return vertices, shares
