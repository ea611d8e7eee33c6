"""The trace of a vertex's weights, and the reason why a joint has none there."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..animation.falloff import explanation
from ..animation.falloff.adjustments import Adjustments
from ..animation.falloff.pipeline import RigFalloff
from ..geodesics import BoneDistances
from ..geodesics.fallback import REACHED
from ..method import Method
from ..runtime.display import count
from ..weights.skinning_weights import LIMIT_LABELS

LOST_BELOW = 1e-4
"""A joint with less after a step has lost its share."""
STEP_LABELS = explanation.FALLOFF_LABELS | LIMIT_LABELS
"""Labels of the steps from distances to weights. A binding has some of them, and then a step for
each layer that changes the vertex, by its title."""
AT_STEP = explanation.LOST_AT | {
    "storable": "The file cannot store weights of this joint at the vertex.",
    "threshold": "Its weight was below the threshold, {threshold:.1%} of the sum.",
    "limit": "{others} more weight, and {limit} are kept.",
}
"""Sentences for steps of the binding; others are called by their labels."""


@dataclass(frozen=True, eq=False)
class Trace:
    """What the weights of a vertex come from.

    Parameters
    ----------
    vertex : int
    method : Method
    distances : BoneDistances
    allowed : array, shape (n, j), bool, or None
        Which joints each vertex may follow.
    adjustments : Adjustments or None
    falloff : RigFalloff or None
        None with the paper's falloff.
    rows : dict of str to array, shape (j,)
        The weights of the vertex after each step and each layer, in their order.
    """

    vertex: int
    method: Method
    distances: BoneDistances
    allowed: NDArray[np.bool_] | None
    adjustments: Adjustments | None
    falloff: RigFalloff | None
    rows: dict[str, NDArray[np.float64]] = field(default_factory=dict)

    @property
    def last(self) -> NDArray[np.float64]:
        """The weights after the last step."""
        return next(reversed(self.rows.values()))

    def rank(self, joint: int, length: float) -> int | None:
        """Return the rank of a joint among those near, 1 for the nearest; None without a path.

        The length is the joint's distance, or that of its path where it is not among the nearest.
        """
        near = self.distances.at(slice(None), self.vertex)
        if not np.isfinite(near[joint]) and not length:
            return None
        return 1 + int((near < min(near[joint], length or np.inf)).sum())

    def factors(self, joint: int) -> dict[str, float]:
        """Return what the falloff multiplies a joint's distance by."""
        gain = 1.0 if self.adjustments is None else float(self.adjustments.gain[joint])
        factors: dict[str, float] = {}
        if self.falloff is not None:
            factors = explanation.factors_of(self.falloff, self.vertex, joint, gain)
        return factors if gain == 1 else factors | {"gain": 1 / gain}

    def absence(self, joint: int, has_path: bool, factors: dict[str, float]) -> str:
        """Return why a joint has no weight, in a sentence; the factors are of its distance."""
        if joint not in self.distances.bones.joint:
            return "The joint does not deform the mesh."
        if self.allowed is not None and not self.allowed[self.vertex, joint]:
            return AT_STEP["storable"]
        alive = [name for name, row in self.rows.items() if row[joint] > LOST_BELOW]
        if not alive:
            return self._without_share(joint, has_path, factors)
        names = list(self.rows)
        lost = names[names.index(alive[-1]) + 1]
        if lost not in STEP_LABELS:
            return f"The layer “{lost}” gives it no weight."
        if lost != "limit":
            return AT_STEP.get(lost, f"Its weight was removed at “{STEP_LABELS[lost]}”.")
        before, limit = self.rows[alive[-1]], self.method.max_influences
        others = int((before > before[joint]).sum())
        code = "limit" if limit is not None and others >= limit else "threshold"
        return AT_STEP[code].format(
            others=count(others, "joint", "have"), limit=limit, threshold=self.method.threshold
        )

    def _without_share(self, joint: int, has_path: bool, factors: dict[str, float]) -> str:
        """Return why a joint has no share of the first step."""
        near = self.distances.at(slice(None), self.vertex)
        if self.distances.fallback[self.vertex] != REACHED and not np.isfinite(near[joint]):
            return "No path reaches the vertex, and other bones are nearer in a straight line."
        if not has_path and not np.isfinite(near[joint]):
            return "No path through the body leads from the vertex to the joint."
        if not np.isfinite(near[joint]):
            return "It is farther than the nearest joints, which share the vertex."
        ratio = float(near[joint] / near.min())
        if self.falloff is not None and explanation.is_barred(ratio, factors, LOST_BELOW):
            return "Its bone lies in another connected component, which counts as farther."
        return f"It is too far: its distance is {ratio:.2g} times the smallest."
