"""The falloff for rigs: weights that animate well, from geodesic distances (docs/falloff.md)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geodesics import BoneDistances
from ...runtime.compiled import no_refcount
from ...runtime.progress import Tell, share_of
from ...runtime.threads import run_parallel
from ..adjustments import Adjustments
from ..context import Step, WeightContext
from .containment import make_rigid
from .diffusion import Diffusion
from .division import Division
from .rigid_accessories import attach_accessories
from .surface_operators import SurfaceOperators

TAIL = 0.05
"""Of a vertex's largest weight: subtracted from all its weights, so that they end somewhere."""


def divide_and_prepare(
    distances: BoneDistances,
    surface: SurfaceOperators,
    adjustments: Adjustments | None = None,
    report: Tell = lambda done: None,
) -> tuple[Division, Diffusion]:
    """Divide the surface; prepare its diffusion by the distance to the nearest bone."""
    depth, resolution = distances.at_welded.min(axis=0), distances.graph.lattice.resolution
    return run_parallel(
        lambda: Division.by(distances, surface, adjustments),
        lambda: Diffusion.over(surface, depth, resolution),
    )


def share(weights: NDArray[np.float64], context: WeightContext) -> NDArray[np.float64]:
    """Begin with each joint's share of the surface."""
    assert context.division is not None
    return context.division.weights


def spread(weights: NDArray[np.float64], context: WeightContext) -> NDArray[np.float64]:
    """Spread shares over the skin by diffusion."""
    assert context.diffusion is not None
    return context.diffusion.spread(weights, share_of(context.report, 0.4, 0.8))


def with_rigid_parts(weights: NDArray[np.float64], context: WeightContext) -> NDArray[np.float64]:
    """Let plates, wheels, eyes, buttons... move rigidly."""
    assert context.division is not None
    containment, surface = context.division.containment, context.division.surface
    independent = np.zeros(len(containment), np.bool_)
    if context.adjustments is not None:
        independent[surface.component[context.adjustments.independent]] = True
    if len(containment) > 1:
        weights = make_rigid(surface, weights, independent)
    return attach_accessories(context.distances.graph, surface, containment, weights, independent)


def without_tail(weights: NDArray[np.float64], context: WeightContext) -> NDArray[np.float64]:
    """Subtract a part of each vertex's largest weight from all of them, in place."""
    _subtract_tail(weights)
    return weights


RIG_STEPS = (
    Step("falloff", share),
    Step("spread", spread),
    Step("rigid", with_rigid_parts),
    Step("tail", without_tail),
)


@no_refcount
def _subtract_tail(weights):
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
