"""The falloff for rigs: weights that animate well, from geodesic distances (docs/falloff.md)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...geodesics import BoneDistances
from ...rig.rows import least
from ...runtime.compiled import compiled
from ...runtime.progress import Tell, share_of
from ...runtime.threads import run_parallel
from .adjustments import Adjustments
from .containment import make_rigid
from .diffusion import Diffusion
from .division import Division
from .garments import drape
from .rigid_accessories import attach_accessories

WEIGHT_FLOOR = 0.05
"""Part of a vertex's largest weight that is subtracted from all its weights, so that they end."""


@dataclass(frozen=True, eq=False)
class RigFalloff:
    """The falloff over one surface, ready to compute weights.

    Parameters
    ----------
    distances : BoneDistances
    division : Division
        The surface divided among the joints.
    diffusion : Diffusion
        Diffusion over the surface.
    independent : array, shape (components,), bool
        Which connected components are never rigid.
    """

    distances: BoneDistances
    division: Division
    diffusion: Diffusion
    independent: NDArray[np.bool_]

    @classmethod
    def over(cls, distances: BoneDistances, adjustments: Adjustments | None = None) -> RigFalloff:
        """Divide the surface of a graph by distances; prepare its diffusion by the nearest."""
        graph = distances.graph
        depth = least(distances.rows)
        division, diffusion = run_parallel(
            lambda: Division.by(distances, adjustments),
            lambda: Diffusion.over(graph.mesh, depth, graph.lattice.resolution),
        )
        independent = np.zeros(len(division.containment), np.bool_)
        if adjustments is not None:
            independent[graph.mesh.component[adjustments.independent]] = True
        return cls(distances, division, diffusion, independent)

    def steps(self, report: Tell) -> Iterator[tuple[str, csr_array]]:
        """Yield the name of each step and the weights (k, j) of welded vertices after it."""
        weights = self.division.weights
        yield "falloff", weights
        weights = self.diffusion.spread(weights, share_of(report, 0.4, 0.8))
        yield "spread", weights
        weights = self.with_rigid_parts(weights)
        yield "rigid", weights
        yield "tail", subtract_floor(weights)

    def with_rigid_parts(self, weights: csr_array) -> csr_array:
        """Drape garments over the body; make plates, wheels, eyes and buttons rigid."""
        graph, independent = self.distances.graph, self.independent
        containment, spread = self.division.containment, weights
        if len(containment) > 1:
            weights = drape(graph, containment, self.diffusion, weights, independent)
            weights = make_rigid(graph.mesh, weights, independent)
        return attach_accessories(graph, containment, weights, spread, independent)


def subtract_floor(weights: csr_array) -> csr_array:
    """Subtract a part of each vertex's largest weight from all of them, in place."""
    _subtract_floor(weights.indptr, weights.data)
    return weights


@compiled
def _subtract_floor(start, weight):
    for v in range(len(start) - 1):
        largest, total = 0.0, 0.0
        for e in range(start[v], start[v + 1]):
            largest = max(largest, weight[e])
        for e in range(start[v], start[v + 1]):
            weight[e] = max(weight[e] - WEIGHT_FLOOR * largest, 0.0)
            total += weight[e]
        for e in range(start[v], start[v + 1]):
            weight[e] /= total
