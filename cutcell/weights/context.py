"""Steps from distances to weights, and what they need."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geodesics import BoneDistances
from ..method import Method
from ..runtime.progress import Tell
from .adjustments import Adjustments
from .rig_falloff.diffusion import Diffusion
from .rig_falloff.division import Division


@dataclass(frozen=True, eq=False)
class WeightContext:
    """The inputs of the steps from distances to weights.

    Parameters
    ----------
    distances : BoneDistances
        With the paper's falloff divided by the gains of the adjustments.
    method : Method
    allowed : array, shape (n, j), bool, or None
        Which joints each vertex may follow.
    adjustments : Adjustments or None
    division : Division or None
        Of the surface among the joints; None with the paper's falloff.
    diffusion : Diffusion or None
        Over the surface; None with the paper's falloff.
    report : callable
        Called with the fraction that is done.
    """

    distances: BoneDistances
    method: Method
    allowed: NDArray[np.bool_] | None
    adjustments: Adjustments | None
    division: Division | None
    diffusion: Diffusion | None
    report: Tell


class Step(NamedTuple):
    """A step: `run` takes the weights of the step before and returns those after it.

    They have a row for each vertex if `is_per_vertex`, else for each welded vertex.
    """

    name: str
    run: Callable[[NDArray[np.float64], WeightContext], NDArray[np.float64]]
    is_per_vertex: bool = False
