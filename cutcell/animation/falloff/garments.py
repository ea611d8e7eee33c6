"""Garments over a body: large components without bones follow the body under them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...graph import CutCellGraph
from ...rig.rows import scaled, with_rows
from .components import MAX_RIGID_SIZE, longest_sides
from .containment import ramp
from .diffusion import Diffusion
from .rigid_accessories import nearest_on_body
from .surface_operators import SurfaceOperators

OF_BODY = 0.4, 0.6
"""A component is a garment if joints with bones in the body have the second part of its weight;
less and less so down to the first. A wing that is one sheet has its own bones beside the body."""
IN_COMPONENT = 0.5
"""Part of such a bone that is inside a component."""


def drape(
    graph: CutCellGraph,
    surface: SurfaceOperators,
    containment: NDArray[np.float64],
    diffusion: Diffusion,
    weights: csr_array,
    independent: NDArray[np.bool_],
) -> csr_array:
    """Give garments the weights of the nearest surface of the body, smoothed: capes, skirts.

    Shapes: containment (components, j), weights (k, j), independent (components,); returns (k, j).
    """
    component, areas = surface.component, surface.areas
    has_bones = np.asarray(containment.max(axis=1) > 0)
    is_garment = (
        ~has_bones & ~independent & (longest_sides(surface.points, component) > MAX_RIGID_SIZE)
    )
    of_body = areas * (weights @ (containment.max(axis=0) >= IN_COMPONENT))
    part = np.bincount(component, of_body) / np.maximum(np.bincount(component, areas), 1e-300)
    follows = np.where(is_garment, ramp(part, *OF_BODY), 0)[component]
    garment = np.flatnonzero(follows)
    if not len(garment):
        return weights
    _, mean = nearest_on_body(graph, has_bones[component], surface.points[garment])
    # Components do not conduct to each other: garments are spread by themselves.
    draped = with_rows(csr_array(weights.shape), garment, mean @ weights)
    return scaled(weights, 1 - follows) + scaled(diffusion.spread(draped), follows)
