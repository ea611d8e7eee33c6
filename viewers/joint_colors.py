"""The colours that a rig's joints have in every scene."""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from cutcell.rig import Rig, Skeleton, TriangleMesh

from .palette import joint_colors

CELLS = 32
"""Cells along a mesh's longest side: skin in cells that touch is near."""
SAMPLES = 4
"""Points on each bone that the skin of a rig without weights is divided by."""

_of_mesh: WeakKeyDictionary[TriangleMesh, Any] = WeakKeyDictionary()


def colors_of(rig: Rig) -> NDArray[np.float64]:
    """Return a colour for each joint of a rig, shape (j, 3); see `palette.joint_colors`.

    The file's weights say whose skin touches, so that colours stay while new weights change;
    without any, the nearest bones do.
    """
    given: NDArray[np.float64] | None = getattr(rig, "colors", None)
    if given is not None:  # a few vertices of a rig are drawn in the colours of all
        return given
    mesh, skeleton, weights = rig.mesh, rig.skeleton, rig.weights
    tree = skeleton.parents.tobytes(), skeleton.deform.tobytes() if weights is None else b""
    cached = _of_mesh.get(mesh)
    if cached is None or cached[0] is not weights or cached[1] != tree:
        owner = _nearest(mesh, skeleton) if weights is None else weights.argmax(axis=1)
        owner = np.asarray(owner).ravel()
        sizes = np.bincount(owner, minlength=len(skeleton.parents))
        neighbours = _touching(mesh.faces, owner), _nearby(mesh.vertices, owner)
        cached = weights, tree, joint_colors(skeleton.parents, *neighbours, sizes)
        _of_mesh[mesh] = cached
    colors: NDArray[np.float64] = cached[2]
    return colors


def _touching(faces: NDArray, owner: NDArray) -> NDArray[np.intp]:
    """Return the pairs of joints that faces (m, 3) join, (k, 2), by the joint of each vertex."""
    joint = owner[faces]
    return np.unique(np.concatenate([joint[:, [0, 1]], joint[:, [1, 2]], joint[:, [2, 0]]]), axis=0)


def _nearby(vertices: NDArray, owner: NDArray) -> NDArray[np.intp]:
    """Return the pairs of joints with vertices (n, 3) in the same or adjacent cells, (k, 2)."""
    low, side = vertices.min(axis=0), np.ptp(vertices, axis=0).max() or 1.0
    cell = np.floor((vertices - low) / side * CELLS).astype(int)
    shape = (CELLS + 1,) * 3
    cells, which = np.unique(np.ravel_multi_index(tuple(cell.T), shape), return_inverse=True)
    places = np.stack(np.unravel_index(cells, shape), axis=1)
    adjacent = cKDTree(places).query_pairs(1, p=np.inf, output_type="ndarray")
    holds = csr_array((np.ones(len(owner)), (which, owner)))
    shared = holds.T @ holds + holds[adjacent[:, 0]].T @ holds[adjacent[:, 1]]
    return np.stack(shared.nonzero(), axis=1)


def _nearest(mesh: TriangleMesh, skeleton: Skeleton) -> NDArray[np.intp]:
    """Return the joint whose bones are nearest to each vertex, (n,)."""
    child = np.flatnonzero(skeleton.parents >= 0)
    parent = skeleton.parents[child]
    along = np.linspace(0, 1, SAMPLES, endpoint=False)[:, None, None]
    start, end = skeleton.joints[parent], skeleton.joints[child]
    points = np.concatenate([skeleton.joints, (start + along * (end - start)).reshape(-1, 3)])
    joint = np.concatenate([np.arange(len(skeleton.joints)), np.tile(parent, SAMPLES)])
    carries = skeleton.deform[joint]
    if carries.any():
        points, joint = points[carries], joint[carries]
    return joint[cKDTree(points).query(mesh.vertices)[1]]
