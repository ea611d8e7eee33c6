"""Weights while joints are on the move: a moment before they are exact."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..corrections import Corrections
from ..geodesics.moved import moved_distances
from ..method import Method
from ..progress import Tell
from ..rig import Rig
from .bind import Binding
from .correct import adjustments_of, joints_measured
from .diffusion import Diffusion
from .surface_operators import SurfaceOperators
from .weights import skinning_weights

UNSEEN = 1e-3
"""Weights that differ by less have colours that differ by less than one of their 256 shades."""


class Preview:
    """Weights of a rig whose joints are dragged, from those that were bound before.

    Only the distances of bones that changed are measured. The matrix of the diffusion is that of
    the first place, and joints whose share of the surface has hardly changed are not spread again.
    `cutcell.bind` gives the exact weights.

    Parameters
    ----------
    rig : Rig
    binding : Binding
        Of the rig.
    method : Method
    corrections : Corrections
        Of the rig; their positions do not matter.
    """

    def __init__(
        self, rig: Rig, binding: Binding, method: Method, corrections: Corrections
    ) -> None:
        self._binding, self._method = binding, method
        self._adjustments = adjustments_of(rig, binding.graph, corrections)
        self._within = joints_measured(corrections, method)[1]
        self._diffusion: Diffusion | None = None
        if method.falloff == "rig":
            depth = binding.distances.at_welded.min(axis=0)
            surface = SurfaceOperators.of(binding.graph)
            self._diffusion = _Repeated.over(surface, depth, binding.graph.lattice.resolution)

    def bind(self, rig: Rig) -> Binding:
        """Return about what `bind` would for the rig with its joints elsewhere."""
        distances = moved_distances(
            self._binding.distances, rig.skeleton, self._method, self._within
        )
        weights = skinning_weights(
            distances,
            method=self._method,
            adjustments=self._adjustments,
            diffusion=self._diffusion,
        )
        return replace(self._binding, distances=distances, weights=weights)


@dataclass(frozen=True, eq=False)
class _Repeated(Diffusion):
    """A diffusion that is solved again only for joints whose part of the right side has changed."""

    _known: list[NDArray[np.float64]] = field(default_factory=list)
    """Right sides, shape (k, j), and the equilibrium of each column."""

    def equilibrium(self, weights: NDArray[np.float64], tell: Tell) -> NDArray[np.float64]:
        if not self._known:
            self._known.extend([weights.copy(), super().equilibrium(weights, tell)])
        right, spread = self._known
        changed = np.flatnonzero(np.abs(weights - right).max(axis=0) > UNSEEN)
        right[:, changed] = weights[:, changed]
        self.solve(right, changed, spread, tell)
        return spread.copy()
