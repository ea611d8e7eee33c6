"""Left and right of a skeleton alike."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

ALIKE = 0.06
"""Of the body's longest side: left and right joints that differ by less are made alike."""

Joints = dict[str, NDArray[np.float64]]
"""Where each joint is, by its name, in the body's frame."""


def mirrored(joints: Joints, size: float) -> Joints:
    """Return joints in a frame whose x is 0 in the middle, those of left and right alike.

    Joints are returned unchanged if the two sides have different poses.
    """
    flip = np.array([-1.0, 1.0, 1.0])
    pairs = [(name, f"{name[:-2]}.R") for name in joints if name.endswith(".L")]
    gaps = [float(np.linalg.norm(joints[a] - flip * joints[b])) for a, b in pairs]
    if max(gaps, default=np.inf) > ALIKE * size:
        return joints
    result = {name: place * [0.0, 1.0, 1.0] for name, place in joints.items()}
    for a, b in pairs:
        result[a] = (joints[a] + flip * joints[b]) / 2
        result[b] = flip * result[a]
    return result
