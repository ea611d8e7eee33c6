"""Spaces of rigs: a target is placed beside the source as both are in their scenes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...rig import Rig, Skeleton, TriangleMesh
from ...rig.names import same_names
from ...rig.rig import FAR_OUTSIDE, times_outside

SAME = 1e-6
"""Largest relative difference of the places of two rigs that share a space."""


def between(target: Rig, source: Rig) -> NDArray[np.float64] | None:
    """Return the matrix (4, 4) from a target's space to the source's; None for the same space.

    Files that pose the same skeleton otherwise may place the same space otherwise in the scene: if
    joints of equal names are closer to each other without the matrix, it is left out.
    """
    size = np.abs(source.world).max()
    if np.allclose(target.world, source.world, rtol=0, atol=SAME * size):
        return None
    matrix = np.asarray(np.linalg.solve(source.world, target.world))
    partner = same_names(source.skeleton.names, target.skeleton.names)
    joints, own = (
        source.skeleton.joints[partner >= 0],
        target.skeleton.joints[partner[partner >= 0]],
    )
    away = [np.linalg.norm(points - joints) for points in (own, _moved(own, matrix))]
    return None if len(own) and away[0] <= away[1] else matrix


def moved_mesh(mesh: TriangleMesh, matrix: NDArray[np.float64] | None) -> TriangleMesh:
    """Return a mesh in another space; a reflection keeps its outside."""
    if matrix is None:
        return mesh
    outward = 1 if np.linalg.det(matrix[:3, :3]) > 0 else -1
    return TriangleMesh(_moved(mesh.vertices, matrix), mesh.faces[:, ::outward])


def with_skeleton(target: Rig, source: Rig) -> Rig:
    """Return a target without joints with the source's, where they are in the scene.

    Joints that are too far from a small target, such as an eye, do not deform it.
    """
    matrix, skeleton = between(target, source), source.skeleton
    if matrix is not None:
        skeleton = moved_skeleton(skeleton, np.asarray(np.linalg.inv(matrix), np.float64))
    near = skeleton.deform & (times_outside(skeleton, target.mesh.bounds) <= FAR_OUTSIDE)
    if near.any():  # else they are in different units
        skeleton = replace(skeleton, deform=near)
    return replace(target, skeleton=skeleton, weights=None, weight_sums=None)


def moved_skeleton(skeleton: Skeleton, matrix: NDArray[np.float64]) -> Skeleton:
    """Return a skeleton in another space."""
    axes = skeleton.orientations
    if axes is not None:
        axes = matrix[:3, :3] @ axes
        axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    return replace(skeleton, joints=_moved(skeleton.joints, matrix), orientations=axes)


def _moved(points: NDArray[np.float64], matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    return points @ matrix[:3, :3].T + matrix[:3, 3]
