"""Weights while joints are on the move: a moment before they are exact."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cutcell.binding import Binding
from cutcell.editing.correct import adjustments_of, joints_measured
from cutcell.editing.corrections import Corrections
from cutcell.geodesics import BoneDistances
from cutcell.method import Method
from cutcell.rig import Rig
from cutcell.weights.context import Context, run
from cutcell.weights.rig_falloff.division import Division
from cutcell.weights.rig_falloff.pipeline import RIG_STEPS
from cutcell.weights.skinning_weights import (
    keep_strongest,
    of_vertices,
    skinning_weights,
)

from .moved_distances import MovedDistances

UNSEEN = 1e-3
"""Weights that differ by less have colours that differ by less than one of their 256 shades."""


class Preview:
    """Weights of a rig whose joints are dragged, from those that were bound before.

    Only the distances of bones that changed are measured; with the falloff "rig" only the surface
    that they reach is divided again, and only joints whose share of it has changed are spread.
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
        within = joints_measured(corrections, method)[1]
        self._distances = MovedDistances(binding.distances, method, within)
        self._falloff: _IncrementalFalloff | None = None
        if method.falloff == "rig":
            context = Context(
                method,
                graph=binding.graph,
                distances=binding.distances,
                adjustments=self._adjustments,
            )
            self._falloff = _IncrementalFalloff(run(RIG_STEPS[:1], context))

    def bind(self, rig: Rig) -> Binding:
        """Return about what `bind` would for the rig with its joints elsewhere."""
        distances = self._distances.measure(rig.skeleton)
        if self._falloff is None:
            weights = skinning_weights(
                distances, method=self._method, adjustments=self._adjustments
            )
        else:
            options = self._method.max_influences, self._method.threshold
            welded = keep_strongest(distances, self._falloff.weights(distances), *options)
            weights = of_vertices(distances.graph, welded)
        return replace(self._binding, distances=distances, weights=weights)


class _IncrementalFalloff:
    """The falloff for rigs where few distances have changed a little.

    The matrix of the diffusion is as it was, and joints whose share of the surface has hardly
    changed are not spread again.

    Parameters
    ----------
    context : Context
        Of the distances as they were, with the division and the diffusion.
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._spread = context.diffusion.equilibrium(context.division.weights)

    def weights(self, distances: BoneDistances) -> NDArray[np.float64]:
        """Return the weights (k, j) of welded vertices by the distances of now."""
        before, diffusion = self._context.division, self._context.diffusion
        weights = self._spread.copy()
        division = Division.by(distances, before.surface, self._context.adjustments, before)
        change = np.abs(division.weights - before.weights).max(axis=0)
        changed = np.flatnonzero(change > UNSEEN)
        weights[:, changed] = 0
        diffusion.solve(division.weights, changed, weights)
        diffusion.normalise(weights, division.weights)
        context = replace(self._context, distances=distances, division=division, weights=weights)
        return run(RIG_STEPS[2:], context).weights
