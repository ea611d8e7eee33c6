"""Which local axis of the joints points along their bones: what a rig's own habit tells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..rig import Skeleton

ALONG = np.cos(np.radians(10))
"""An axis points along a bone if it is within 10 degrees of it."""
MOST = 0.6
"""Of the bones that have no choice but to run to an only child: so many must agree."""
LEAST_BONES = 3
"""Fewer say nothing."""
SHORTEST = 1e-3
"""Of the longest side: shorter bones point nowhere in particular."""


def rest_directions(skeleton: Skeleton, joints: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Find the local axis along which the joints' bones point, and where it points at each.

    A modelling program builds joints so that one local axis, nearly always +Y, runs along the
    bone. The joints with one child show which; the last joints, which have none, have it too.

    Parameters
    ----------
    skeleton : Skeleton
    joints : array, shape (j, 3)
        Its joints in the unit cube.

    Returns
    -------
    array, shape (j, 3), or None
        Unit vectors in the mesh's frame. None where the file does not hold the joints' rest
        orientation, or where no axis points along most bones.
    """
    if skeleton.orientations is None:
        return None
    local = []
    for j, children in enumerate(skeleton.children):
        away = joints[children] - joints[j]
        length = np.linalg.norm(away, axis=1)
        if np.count_nonzero(length > SHORTEST) == 1:
            only = length.argmax()
            local.append(skeleton.orientations[j].T @ (away[only] / length[only]))
    if len(local) < LEAST_BONES:
        return None
    # Columns: how many bones run along x, y, z, -x, -y, -z.
    signed = np.hstack([np.array(local), -np.array(local)])
    agree = (signed > ALONG).mean(axis=0)
    best = int(agree.argmax())
    if agree[best] < MOST:
        return None
    return skeleton.orientations[:, :, best % 3] * (1 if best < 3 else -1)
