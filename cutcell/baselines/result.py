"""What every method returns, and what all methods do last."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..checks import check_integer, check_number
from ..rig import Rig
from ..skinning.prune import prune
from .body import Body

MOST_INFLUENCES = 1024


@dataclass(frozen=True, eq=False)
class BaselineBinding:
    """A rig bound by any method; it has the fields of `Binding` that all methods share.

    Parameters
    ----------
    weights : array, shape (n, j), float64, or None
        For the rig's own vertices, in their order; None where the method failed.
    seconds : dict of str to float
        Time taken by each stage.
    warnings : tuple of str
        What a person should know about the result, in sentences.
    failed : str
        Why there are no weights, in a sentence; empty where there are.
    """

    weights: NDArray[np.float64] | None
    seconds: Mapping[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    failed: str = ""


def finish(
    rig: Rig,
    body: Body,
    weights: NDArray[np.float64],
    *,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Give weights of places back to the file's vertices, fit to be stored and compared.

    Negative numbers and joints that may carry no weight are dropped; a vertex that is left
    with none follows its nearest bone.

    Parameters
    ----------
    rig : Rig
    body : Body
        Of the rig.
    weights : array, shape (k, j)
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    weights : array, shape (n, j)
        Rows sum to one.
    warnings : tuple of str

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    threshold = check_number("threshold", threshold, 0, 1)
    if max_influences is not None:
        max_influences = check_integer("max_influences", max_influences, 1, MOST_INFLUENCES)
    full = np.where(np.isfinite(weights), np.maximum(weights, 0), 0)[body.index]
    full[:, ~rig.skeleton.deform] = 0
    if rig.allowed is not None:
        full = np.where(rig.allowed, full, 0)
    warnings: tuple[str, ...] = ()
    lost = np.flatnonzero(full.sum(axis=1) <= 0)
    if len(lost):
        full[lost] = _nearest(rig, body, lost)
        warnings = (
            f"{len(lost)} of {len(full)} vertices got no weight that their file can store; "
            "they follow their nearest bone",
        )
    full /= full.sum(axis=1, keepdims=True)
    priority = np.lexsort(rig.skeleton.joints.T[::-1])
    return prune(full, max_influences, threshold, priority), warnings


def _nearest(rig: Rig, body: Body, vertices: NDArray[np.intp]) -> NDArray[np.float64]:
    distance = body.joint_minimum(body.straight())[:, body.index[vertices]].T
    if rig.allowed is not None:
        distance = np.where(rig.allowed[vertices], distance, np.inf)
    rows = np.zeros(distance.shape)
    rows[np.arange(len(rows)), distance.argmin(axis=1)] = 1
    return rows
