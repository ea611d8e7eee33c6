"""Approximate weights while joints are being moved."""

from __future__ import annotations

from dataclasses import replace

from scipy.sparse import csr_array

from cutcell.animation.falloff.adjustments import Adjustments
from cutcell.animation.falloff.division import Division
from cutcell.animation.falloff.pipeline import RigFalloff, subtract_floor
from cutcell.binding.binding import Binding
from cutcell.editing.edited import adjustments_of, joints_measured
from cutcell.editing.layers.contents import Computed
from cutcell.geodesics import BoneDistances
from cutcell.method import Method
from cutcell.rig import Rig
from cutcell.rig.rows import chosen_entries
from cutcell.weights.skinning_weights import keep_strongest, skinning_weights

from .moved_distances import MovedDistances

UNSEEN = 1e-3
"""Difference of weights whose colours differ by less than one of 256 shades."""


class Preview:
    """Approximate weights of a rig whose joints are being moved, from a binding.

    Only the distances of changed bones are measured. With the falloff "rig", only the surface near
    them is divided again, and only joints whose share has changed are spread. `cutcell.bind`
    computes the exact weights.

    Parameters
    ----------
    rig : Rig
    binding : Binding
        Of the rig.
    method : Method
    reach : Computed, optional
        Gains and radii of the binding.
    """

    def __init__(
        self, rig: Rig, binding: Binding, method: Method, reach: Computed | None = None
    ) -> None:
        self._binding, self._method = binding, method
        self._adjustments = adjustments_of(rig, binding.graph, reach or Computed())
        within = joints_measured(reach or Computed(), method)[1]
        self._distances = MovedDistances(binding.distances, method, within)
        self._falloff: _IncrementalFalloff | None = None
        if method.falloff == "rig":
            self._falloff = _IncrementalFalloff(binding.distances, self._adjustments)

    def bind(self, rig: Rig) -> Binding:
        """Return about the binding of the rig with its joints elsewhere."""
        distances, method = self._distances.measure(rig.skeleton), self._method
        if self._falloff is None:
            weights = skinning_weights(distances, method=method, adjustments=self._adjustments)
            rows = csr_array(weights)
        else:
            options = method.max_influences, method.threshold
            welded = keep_strongest(distances, self._falloff.weights(distances), *options)
            rows = welded[distances.graph.vertex_node]
        return replace(self._binding, distances=distances, rows=rows)


class _IncrementalFalloff:
    """The falloff "rig" after small changes of few distances.

    The matrix of the diffusion stays, and only joints whose share of the surface has changed
    noticeably are spread again.
    """

    def __init__(self, distances: BoneDistances, adjustments: Adjustments | None) -> None:
        self._falloff, self._adjustments = RigFalloff.over(distances, adjustments), adjustments
        self._spread = self._falloff.diffusion.equilibrium(self._falloff.division.weights)

    def weights(self, distances: BoneDistances) -> csr_array:
        """Return the weights (k, j) of welded vertices for changed distances."""
        before, diffusion = self._falloff.division, self._falloff.diffusion
        division = Division.by(distances, self._adjustments)
        is_changed = abs(division.weights - before.weights).max(axis=0).toarray() > UNSEEN
        spread, shares = self._spread, division.weights
        changed = chosen_entries(shares, is_changed[shares.indices])
        unchanged = chosen_entries(spread, ~is_changed[spread.indices])
        weights = unchanged + diffusion.equilibrium(changed)
        weights = diffusion.whole(weights, division.weights)
        return subtract_floor(replace(self._falloff, division=division).with_rigid_parts(weights))
