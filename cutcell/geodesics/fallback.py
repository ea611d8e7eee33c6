"""Distances for vertices that no path reaches (paper section 3.2, "Unreachable vertices")."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.segments import distance_to_segment
from .bones import Bones

REACHED, UNUSED, UNREACHED, NOT_ALLOWED = range(4)

FALLBACK_REASONS = (
    "reached through the body",
    "no face uses the vertex",
    "no path through the body leads from a bone to the vertex's part of the mesh",
    "its file cannot store weights of the joints that reach the vertex",
)
"""What each value of `BoneDistances.fallback` means."""


def straight_to_nearest(
    points: NDArray[np.float64],
    bones: Bones,
    nearest: int,
    allowed: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64]:
    """Compute straight distances to the nearest bones of each point; infinity to all others.

    Shapes: points (p, 3), allowed (p, b); returns (b, p).
    """
    distance = np.stack(
        [
            distance_to_segment(points, start, end)
            for start, end in zip(bones.start, bones.end, strict=True)
        ]
    )
    if allowed is not None:
        distance = np.where(allowed.T, distance, np.inf)
    if nearest < len(distance):
        limit = np.partition(distance, nearest - 1, axis=0)[nearest - 1]
        distance = np.where(distance <= limit, distance, np.inf)
    return distance
