"""The plane of symmetry of a skeleton, whatever its mesh."""

import numpy as np
from numpy.typing import NDArray

from cutcell.editing.symmetry import (
    JOINT_TOLERANCE,
    MIN_MIRRORED,
    VERTEX_TOLERANCE,
    Mirror,
    mesh_diagonal,
    mirror_planes,
    reflected,
    with_set_pairs,
)
from cutcell.errors import SkeletonError
from cutcell.rig import Rig
from cutcell.rig.names import plain


def joint_mirror(rig: Rig) -> Mirror:
    """Find the plane, orthogonal to x, y or z, across which most joints have a partner.

    Unlike for `find_mirror` the mesh need not be mirrored: hair seldom is. No vertex is paired.
    """
    joints = rig.skeleton.joints
    if not len(joints):
        raise SkeletonError(f"{rig.name} has no joints, so none has a partner on the other side")
    best, share, matched = None, 0.0, 0.0
    tolerance = JOINT_TOLERANCE * mesh_diagonal(rig)
    for axis, position, joint in mirror_planes(rig):
        gap = reflected(joints, axis, position)[joint >= 0] - joints[joint[joint >= 0]]
        exact = 1 - float(np.linalg.norm(gap, axis=1).mean()) / tolerance
        score = float((joint >= 0).mean()) + 0.1 * exact
        if score > share:
            share, matched = score, float((joint >= 0).mean())
            best = with_set_pairs(rig, axis, position, np.empty(0, np.intp), joint)
    if best is None or matched < MIN_MIRRORED:
        raise SkeletonError(
            f"the skeleton of {rig.name} is not mirrored across x, y or z: less than half of its "
            "joints have a partner on the other side"
        )
    return best


def side_is_positive(rig: Rig, plane: Mirror, side: str) -> bool:
    """Return whether a side, "l" or "r", is that of larger coordinates, by the names of joints."""
    names = np.array([plain(name)[1] for name in rig.skeleton.names])
    offset = rig.skeleton.joints[:, plane.axis] - plane.position
    left, right = (offset[names == one] for one in "lr")
    if not len(left) or not len(right):  # characters look along z, and x points to their left
        return side == "l"
    return bool((left.mean() > right.mean()) == (side == "l"))


def side_of(rig: Rig) -> NDArray[np.int_]:
    """Return the side of each vertex, shape (n,): 1 for left, -1 for right, 0 for the middle."""
    plane = joint_mirror(rig)
    offset = rig.mesh.vertices[:, plane.axis] - plane.position
    side = np.sign(offset) * (np.abs(offset) > VERTEX_TOLERANCE * mesh_diagonal(rig))
    return side.astype(int) * (1 if side_is_positive(rig, plane, "l") else -1)
