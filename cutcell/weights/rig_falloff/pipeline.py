"""The falloff for rigs: weights that animate well, from geodesic distances (docs/falloff.md)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ...geodesics import BoneDistances
from ...runtime.compiled import no_refcount
from ...runtime.progress import Tell, share_of
from ...runtime.threads import run_parallel
from ..adjustments import Adjustments
from .containment import make_rigid
from .diffusion import Diffusion
from .division import Division
from .rigid_accessories import attach_accessories
from .surface_operators import SurfaceOperators

TAIL = 0.05
"""Of a vertex' largest weight: subtracted from all its weights, so that they end somewhere."""


Record = Callable[[str, NDArray], None]
"""Is told the name of each step and what it has computed, which may change afterwards."""


def rig_weights(
    distances: BoneDistances,
    surface: SurfaceOperators,
    tell: Tell = lambda done: None,
    record: Record = lambda step, array: None,
    adjustments: Adjustments | None = None,
) -> NDArray[np.float64]:
    """Turn distances into weights for animation.

    Returns shapes (k, j).
    """
    division, diffusion = run_parallel(
        lambda: Division.by(distances, surface, adjustments),
        lambda: diffusion_of(distances, surface),
    )
    for step in ("penalty", "radius", "beyond"):
        record(step, getattr(division, step))
    record("falloff", division.weights)
    weights = diffusion.spread(division.weights, share_of(tell, 0.5, 1))
    record("spread", weights)
    weights = with_rigid_parts(division, weights, adjustments)
    record("rigid", weights)
    subtract_tail(weights)
    return weights


def diffusion_of(distances: BoneDistances, surface: SurfaceOperators) -> Diffusion:
    """Return the diffusion over a surface whose depth is the distance to the nearest bone."""
    depth = distances.at_welded.min(axis=0)
    return Diffusion.over(surface, depth, distances.graph.lattice.resolution)


def with_rigid_parts(
    division: Division, weights: NDArray[np.float64], adjustments: Adjustments | None
) -> NDArray[np.float64]:
    """Let plates, wheels, eyes, buttons... move rigidly: weights (k, j) before and after."""
    containment, surface = division.containment, division.surface
    by_itself = None if adjustments is None else adjustments.by_itself
    if len(containment) > 1:
        weights = make_rigid(containment, surface.component, weights, by_itself)
    graph = division.distances.graph
    return attach_accessories(graph, surface, containment, weights, by_itself)


@no_refcount
def subtract_tail(weights):
    """Subtract a part of each vertex' largest weight from all of them, down to zero, in place."""
    for v in range(len(weights)):
        largest = 0.0
        for j in range(weights.shape[1]):
            largest = max(largest, weights[v, j])
        total = 0.0
        for j in range(weights.shape[1]):
            weights[v, j] = max(weights[v, j] - TAIL * largest, 0.0)
            total += weights[v, j]
        for j in range(weights.shape[1]):
            weights[v, j] /= total


def permitted(
    weights: NDArray[np.float64], distance: NDArray[np.float64], allowed: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Take away what a vertex may not follow; one left with nothing follows its nearest joint.

    Shapes: weights (n, j), distance (j, n), allowed (n, j); returns (n, j).
    """
    kept = np.where(allowed, weights, 0.0)
    lost = np.flatnonzero(kept.sum(axis=1) == 0)
    kept[lost, distance[:, lost].argmin(axis=0)] = 1
    return kept / kept.sum(axis=1, keepdims=True)
