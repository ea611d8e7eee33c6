"""The colours that a rig's joints have in every scene."""

from __future__ import annotations

from functools import cache
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from cutcell.rig import Rig, Skeleton, TriangleMesh

from .palette import JOINT_COLORS, differences

CELLS = 32
"""Cells along a mesh's longest side: skin in cells that touch is near."""
SAMPLES = 4
"""Points on each bone that the skin of a rig without weights is divided by."""
ALIKE = 0.015
"""Difference of two colours over which the penalty for giving them to neighbours falls to 1/e."""
ALL_EYES = 0.6
"""Factor of differences to all cones, so that neighbours differ clearly to most people."""
SWEEPS = 30
"""Largest number of sweeps over the joints until none changes its colour; a few are enough."""

_of_mesh: WeakKeyDictionary[TriangleMesh, Any] = WeakKeyDictionary()


def colors_of(rig: Rig) -> NDArray[np.float64]:
    """Return a colour for each joint of a rig, shape (j, 3); see `joint_colors`.

    The file's weights decide whose skin touches, so that colours stay while new weights change;
    without any, the nearest bones do.
    """
    of_all: NDArray[np.float64] | None = getattr(rig, "colors", None)
    if of_all is not None:  # a few vertices of a rig are drawn in the colours of all
        return of_all
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


def joint_colors(
    parents: ArrayLike,
    touching: ArrayLike = (),
    nearby: ArrayLike = (),
    sizes: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return a colour for each joint, distinct from its neighbours' also to colour-blind people.

    Parameters
    ----------
    parents : array_like, shape (j,)
    touching, nearby : array_like, shape (k, 2), optional
        Pairs of joints whose skin touches, and of joints whose skin is near in space.
    sizes : array_like, shape (j,), optional
        Amount of skin of each joint. Joints with much of it differ from each other first.

    Returns
    -------
    array, shape (j, 3), float64
        Red, green and blue from 0 to 1, each one of `JOINT_COLORS`.
    """
    above = np.asarray(parents, int)
    size = np.ones(len(above)) if sizes is None else np.asarray(sizes, float)
    touching, nearby = (np.asarray(pairs, int).reshape(-1, 2) for pairs in (touching, nearby))
    conflict = _conflicts(above, touching, nearby, size)
    penalty = np.exp(-_differences() / ALIKE)
    chosen, is_chosen = np.full(len(above), -1), np.zeros((len(above), len(penalty)))
    order = np.argsort(-conflict.sum(axis=1), kind="stable")
    for _ in range(SWEEPS):
        before = chosen.copy()
        for joint in order:
            chosen[joint] = int(np.argmin(conflict[joint] @ is_chosen @ penalty))
            is_chosen[joint] = np.arange(len(penalty)) == chosen[joint]
        if np.array_equal(before, chosen):
            break
    return np.array(JOINT_COLORS)[chosen] / 255


def _conflicts(
    above: NDArray, touching: NDArray, nearby: NDArray, size: NDArray
) -> NDArray[np.float64]:
    """Return the weight of each pair's difference, (j, j), by parents, pairs and sizes."""
    large = np.sqrt(size / size.max(initial=1e-300))
    conflict = 1e-3 + 2e-2 * np.outer(large, large)
    child = np.flatnonzero(above >= 0)
    second = child[above[above[child]] >= 0]
    is_sibling = (above[:, None] == above) & (above >= 0)
    conflict[is_sibling] = np.maximum(conflict[is_sibling], 0.1)

    def raise_to(least: float, a: NDArray, b: NDArray) -> None:
        for pair in ((a, b), (b, a)):
            conflict[pair] = np.maximum(conflict[pair], least)

    raise_to(0.1, second, above[above[second]])
    raise_to(0.2, *nearby.T)
    raise_to(1.0, child, above[child])
    conflict[size == 0] *= 0.05
    conflict[:, size == 0] *= 0.05
    raise_to(1.0, *touching.T)
    np.fill_diagonal(conflict, 0)
    return conflict


@cache
def _differences() -> NDArray[np.float64]:
    """Return the smallest differences of joints' colours over all eyes, (c, c)."""
    colors = np.array(JOINT_COLORS) / 255
    return np.minimum(ALL_EYES * differences(colors, ("all cones",)), differences(colors))


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
