"""The falloff for rigs: weights that animate well, from geodesic distances (docs/falloff.md)."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from ...runtime.progress import share_of
from ...runtime.threads import run_parallel
from ..context import Context, Step
from ..rows import rows_of_entries, scaled, with_data
from .containment import make_rigid
from .diffusion import Diffusion
from .division import Division
from .garments import drape
from .rigid_accessories import attach_accessories

TAIL = 0.05
"""Part of a vertex's largest weight that is subtracted from all its weights, so that they end."""


def share(context: Context) -> csr_array:
    """Divide the surface among joints; prepare its diffusion by the distance to the nearest bone.

    Returns each joint's share of the welded vertices, (k, j).
    """
    distances, surface = context.distances, context.operators()
    rows, resolution = distances.rows, context.graph.lattice.resolution
    depth = np.minimum.reduceat(rows.data, rows.indptr[:-1])
    context.division, context.diffusion = run_parallel(
        lambda: Division.by(distances, surface, context.adjustments),
        lambda: Diffusion.over(surface, depth, resolution),
    )
    return context.division.weights


def spread(context: Context) -> csr_array:
    """Spread shares over the skin by diffusion."""
    return context.diffusion.spread(context.weights, share_of(context.report, 0.4, 0.8))


def with_rigid_parts(context: Context) -> csr_array:
    """Drape garments over the body; make plates, wheels, eyes and buttons rigid."""
    containment, surface = context.division.containment, context.operators()
    weights, independent = context.weights, np.zeros(len(containment), np.bool_)
    if context.adjustments is not None:
        independent[surface.component[context.adjustments.independent]] = True
    if len(containment) > 1:
        weights = make_rigid(surface, drape(context, weights, independent), independent)
    return attach_accessories(context.graph, surface, containment, weights, independent)


def without_tail(context: Context) -> csr_array:
    """Subtract a part of each vertex's largest weight from all of them."""
    weights = context.weights
    tail = TAIL * weights.max(axis=1).toarray()
    data = np.maximum(weights.data - tail[rows_of_entries(weights)], 0.0)
    weights = with_data(weights, data)
    return scaled(weights, 1 / weights.sum(axis=1))


RIG_STEPS = (
    Step("falloff", share),
    Step("spread", spread),
    Step("rigid", with_rigid_parts),
    Step("tail", without_tail),
)
