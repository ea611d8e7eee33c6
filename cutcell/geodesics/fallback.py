"""Distances for vertices that no path reaches (paper section 3.2, "Unreachable vertices")."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..bones.bones import Bones, Sources
from ..geometry.segments import distance_to_segment
from ..geometry.vectors import TIE
from .solver import BoneDistanceSolver

REACHED, UNUSED, UNREACHED, NOT_ALLOWED = range(4)

FALLBACK_REASONS = (
    "reached through the body",
    "no face uses the vertex",
    "no path through the body leads from a bone to the vertex's part of the mesh",
    "its file cannot store weights of the joints that reach the vertex",
)
"""Meaning of each value of `BoneDistances.fallback`."""


def why_not_reached(
    solver: BoneDistanceSolver,
    bones: Bones,
    sources: Sources,
    rows: csr_array,
    node: NDArray[np.int32],
    allowed: NDArray[np.bool_] | None,
) -> NDArray[np.uint8]:
    """Return why nodes (p,) with distances (p, j) of their joints need a fallback, (p,)."""
    fallback = np.where(np.diff(rows.indptr), REACHED, UNREACHED).astype(np.uint8)
    fallback[~solver.graph.connected[node]] = UNUSED
    lost = np.flatnonzero(fallback == UNREACHED)
    if allowed is not None and len(lost):
        by_any = solver.paths(bones, sources, 1, targets=node[lost])
        fallback[lost[np.diff(by_any.indptr) > 0]] = NOT_ALLOWED
    return fallback


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
        distance = np.where(distance <= limit + TIE, distance, np.inf)
    return distance
