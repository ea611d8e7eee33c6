"""Attached components: what mostly lies on one joint follows it alone, like a wig or a buckle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...animation.falloff.containment import ramp
from ...animation.falloff.rigid_accessories import DOMINANT
from ...geometry.welded import WeldedMesh

IN_SURFACE = 0.0025
"""A vertex at most this far from the source, in diagonals of its bounding box, is in its surface:
levels of detail are, cloth of some thickness is not."""


def attach(
    mesh: WeldedMesh, weights: NDArray[np.float64], distance: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Make components rigid that mostly follow one joint, as `bind` does with accessories.

    Components of which at least half of the vertices are in the surface of the source are copies
    of parts of it. These keep their weights, rigid or not.

    Shapes: weights (k, j); distance (k,), in diagonals of the source; returns (k, j).
    """
    component, vertex = mesh.component, np.arange(len(weights))
    gather = csr_array((mesh.areas + 1e-12, (component, vertex)))
    share = (gather @ weights) / gather.sum(axis=1)[:, None]
    alone = ramp(share.max(axis=1), *DOMINANT)
    alone[2 * np.bincount(component, distance <= IN_SURFACE) >= np.bincount(component)] = 0.0
    part = alone[component]
    result = weights * (1 - part)[:, None]
    result[vertex, share.argmax(axis=1)[component]] += part
    return result
