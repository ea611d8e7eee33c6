"""The table of metrics, which comparisons, evaluations, sweeps and their tables read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Rig
from cutcell.rig.mesh import vertex_shares
from cutcell.runtime.progress import Progress, silent

from .clips import clip_error
from .crosstalk import crosstalk
from .deformation import DeformationError, Turned, deformation_error
from .poses import PoseError, pose_error
from .weight_error import THRESHOLD, precision_recall, unweighted, weight_l1


@dataclass(frozen=True, eq=False)
class Measured:
    """Weights and those they are measured against, with what several metrics need.

    Parameters
    ----------
    rig : Rig
    weights, reference : array_like, shape (n, j)
        Rows sum to one, or to zero.
    binding : Binding or BaselineBinding, optional
        What the weights are of, for metrics of more than weights.
    count : {"welded", "vertices"}
        See `vertex_shares`.
    threshold : float
        See `precision_recall`.
    turned : {"deform", "all"}
        See `deformation_error`.
    gaps : array_like, shape (p, 2)
        See `find_gaps`.
    progress : callable
        See `cutcell.runtime.progress`; the stage is called "deformation".
    """

    rig: Rig
    weights: ArrayLike
    reference: ArrayLike
    binding: Any = None
    count: str = "welded"
    threshold: float = THRESHOLD
    turned: Turned = "deform"
    gaps: ArrayLike = field(default_factory=lambda: np.empty((0, 2), np.int32))
    progress: Progress = silent

    @cached_property
    def share(self) -> NDArray[np.float64]:
        """How much each vertex counts, shape (n,)."""
        return vertex_shares(self.rig.mesh, self.count)

    @cached_property
    def turns(self) -> DeformationError:
        """The deformation error and its parts."""
        return deformation_error(
            self.rig, self.weights, self.reference, joints=self.turned, progress=self.progress
        )

    @cached_property
    def poses(self) -> PoseError:
        """The error in random poses."""
        return pose_error(self.rig, self.weights, self.reference, count=self.count)

    @cached_property
    def precision_recall(self) -> tuple[float, float]:
        """Precision and recall of the influences."""
        return precision_recall(self.weights, self.reference, self.share, threshold=self.threshold)

    def values(self, metrics: Mapping[str, Metric]) -> dict[str, float | None]:
        """Return each of the metrics by name. None: there is nothing to measure."""
        numbers = {name: float(metric.measure(self)) for name, metric in metrics.items()}
        return {name: None if np.isnan(value) else value for name, value in numbers.items()}


@dataclass(frozen=True)
class Metric:
    """One number that describes weights.

    Parameters
    ----------
    heading : str
        Its name in tables.
    measure : callable
        Takes a `Measured` and returns a number; nan where there is nothing to measure.
    unit : str
        Such as "cm²"; empty for a pure number.
    form : str
        Format of the number, such as ".3f".
    lower_is_better : bool
    """

    heading: str
    measure: Callable[[Measured], float]
    unit: str = ""
    form: str = ".3f"
    lower_is_better: bool = True

    @property
    def title(self) -> str:
        """The heading with the unit."""
        return f"{self.heading} {self.unit}".rstrip()

    def text(self, value: float | None) -> str:
        """Write a value of the metric."""
        return "–" if value is None else format(value, self.form)


def _l1(one: Measured) -> float:
    return weight_l1(one.weights, one.reference, one.share)


def _clips(one: Measured) -> float:
    errors = clip_error(one.rig, one.weights, one.reference, count=one.count)
    return float(np.mean([error.largest for error in errors])) if errors else np.nan


METRICS: dict[str, Metric] = {
    "l1": Metric("L1", _l1),
    "precision": Metric("precision", lambda one: one.precision_recall[0], lower_is_better=False),
    "recall": Metric("recall", lambda one: one.precision_recall[1], lower_is_better=False),
    "deformation": Metric("deformation", lambda one: one.turns.mean, "cm²", ".1f"),
    "seconds": Metric("seconds", lambda one: sum(one.binding.seconds.values()), form=".2f"),
    "clips": Metric("own clips", _clips, "cm²", ".1f"),
    "crosstalk": Metric("crosstalk", lambda one: crosstalk(one.weights, one.gaps).mean),
    "unweighted": Metric("no weight", lambda one: unweighted(one.weights, one.share), form=".1%"),
}
"""The metrics by name. Terminals show as many as fit, the first ones first."""
