"""Weights from straight distances, as if nothing lay between bone and skin."""

from __future__ import annotations

from time import perf_counter

from ..checks import check_number
from ..rig import Rig
from ..skinning.kernel import paper_kernel
from .body import Body
from .result import BaselineBinding, finish


def euclidean(
    rig: Rig,
    *,
    alpha: float = 0.5,
    leaf: str = "point",
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by the straight distance to each bone, with the paper's falloff.

    Parameters
    ----------
    rig : Rig
    alpha : float
        Smoothness of the falloff, 0 to 1.
    leaf
        See `bone_segments`.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stages "distances", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    alpha = check_number("alpha", alpha, 0, 1)
    begin = perf_counter()
    body = Body.of(rig, leaf)
    distance = body.joint_minimum(body.straight())
    middle = perf_counter()
    weights = paper_kernel(distance, body.lattice.diagonal, alpha)
    weights, warnings = finish(
        rig, body, weights, max_influences=max_influences, threshold=threshold
    )
    seconds = {"distances": middle - begin, "weights": perf_counter() - middle}
    return BaselineBinding(weights, seconds, warnings)
