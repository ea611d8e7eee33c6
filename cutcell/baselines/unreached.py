"""Vertices that no bone reaches follow their nearest bones, as in the paper."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geodesics.fallback import straight_to_nearest
from .body import Body

NEAREST = 3
"""Bones that a vertex follows which none reaches."""


def follow_nearest(body: Body, distance: NDArray[np.float64], why: str) -> tuple[str, ...]:
    """Give vertices that no bone reaches straight distances to their nearest bones, in place.

    Shapes: distance (b, k).
    """
    lost = np.flatnonzero(~np.isfinite(distance).any(axis=0))
    if len(lost) == 0:
        return ()
    distance[:, lost] = straight_to_nearest(body.points[lost], body.bones, NEAREST)
    return (unreached(lost, body, why),)


def unreached(lost: NDArray[np.intp], body: Body, why: str) -> str:
    """Say how many vertices follow their nearest bones, and why."""
    return (
        f"{len(lost)} of {len(body.points)} welded vertices follow their nearest bones in a "
        f"straight line: {why}"
    )
