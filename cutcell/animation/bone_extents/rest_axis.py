"""The rest axis: which local axis of the joints points along their bones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...rig import Skeleton

ALONG_BONE = np.cos(np.radians(10))
"""An axis points along a bone if it is within 10 degrees of it."""
MIN_AGREEMENT = 0.6
"""Share of the bones to an only child that must agree on the axis."""
MIN_BONES = 3
"""Fewer bones are no evidence."""
MIN_DIRECTED_LENGTH = 1e-3
"""Length, relative to the longest side, below which a bone has no direction."""
SAME_ORIENTATION = 1e-3
"""Largest difference of the axes of joints that are oriented alike."""


def rest_directions(skeleton: Skeleton, joints: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Find the local axis along which the bones of joints point, and its direction at each joint.

    Modelling programs orient joints so that one local axis, nearly always +Y, runs along the bone.
    Joints with one child show which axis it is; leaf joints have it, too. Joints that are all
    oriented alike, as exporters leave them that know no orientation, have none.

    Shapes: joints (j, 3); returns (j, 3).
    """
    if (
        skeleton.orientations is None
        or np.ptp(skeleton.orientations, axis=0).max() < SAME_ORIENTATION
    ):
        return None
    local = []
    for j, children in enumerate(skeleton.children):
        away = joints[children] - joints[j]
        length = np.linalg.norm(away, axis=1)
        if np.count_nonzero(length > MIN_DIRECTED_LENGTH) == 1:
            only = length.argmax()
            local.append(skeleton.orientations[j].T @ (away[only] / length[only]))
    if len(local) < MIN_BONES:
        return None
    # Columns: how many bones run along x, y, z, -x, -y, -z.
    signed = np.hstack([np.array(local), -np.array(local)])
    agree = (signed > ALONG_BONE).mean(axis=0)
    best = int(agree.argmax())
    if agree[best] < MIN_AGREEMENT:
        return None
    return skeleton.orientations[:, :, best % 3] * (1 if best < 3 else -1)
