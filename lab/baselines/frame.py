"""The frame of all baselines: prepare a rig, solve for its welded vertices, finish the weights."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell.isolated.run import WorkFailedError
from cutcell.method import Method
from cutcell.rig import Rig
from cutcell.weights.prune import prune

from .body import Body


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
        Warnings about the result.
    failed : str
        Why there are no weights; empty where there are.
    """

    weights: NDArray[np.float64] | None
    seconds: Mapping[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    failed: str = ""


class Run:
    """The time of each stage of a run of a method, and its warnings."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.warnings: list[str] = []
        self._since = perf_counter()

    def end(self, stage: str, seconds: float | None = None) -> None:
        """Add the time since the last stage ended, or `seconds`, to a stage."""
        now = perf_counter()
        spent = now - self._since if seconds is None else seconds
        self.seconds[stage] = self.seconds.get(stage, 0.0) + spent
        self._since = now


Solve = Callable[[Body, Run], NDArray[np.float64]]
"""The solver of a method: the weights of the welded vertices, shape (k, j), of a body. It ends all
stages but the last, "weights". Numbers that are negative or not finite are dropped later."""


def bind_by(solve: Solve, rig: Rig, method: Method) -> BaselineBinding:
    """Bind a rig by a method."""
    run = Run()
    body = Body.of(rig, method.leaf, method.resolution)
    try:
        welded = solve(body, run)
    except WorkFailedError as error:
        return BaselineBinding(None, run.seconds, tuple(run.warnings), str(error))
    weights, warnings = _finish(rig, body, welded, method)
    run.end("weights")
    return BaselineBinding(weights, run.seconds, (*run.warnings, *warnings))


def _finish(
    rig: Rig, body: Body, weights: NDArray[np.float64], method: Method
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Return the weights of the file's vertices, (n, j), from those of welded ones, and warnings.

    Negative numbers and joints that may carry no weight are dropped; a vertex that is left
    with none follows its nearest bone. Rows sum to one.
    """
    full = np.where(np.isfinite(weights), np.maximum(weights, 0), 0)[body.index]
    full[:, ~rig.skeleton.deform] = 0
    if rig.allowed is not None:
        full = np.where(rig.allowed, full, 0)
    warnings: tuple[str, ...] = ()
    lost = np.flatnonzero(full.sum(axis=1) <= 0)
    if len(lost):
        full[lost] = _nearest(rig, body, lost)
        warnings = (
            f"{len(lost):,} of {len(full):,} vertices got no weight that their file can store; "
            "they follow their nearest bone",
        )
    full /= full.sum(axis=1, keepdims=True)
    priority = np.lexsort(rig.skeleton.joints.T[::-1])
    few = prune(csr_array(full), method.max_influences, method.threshold, priority)
    return few.toarray(), warnings


def _nearest(rig: Rig, body: Body, vertices: NDArray[np.intp]) -> NDArray[np.float64]:
    distance = body.joint_minimum(body.straight())[:, body.index[vertices]].T
    if rig.allowed is not None:
        distance = np.where(rig.allowed[vertices], distance, np.inf)
    rows = np.zeros(distance.shape)
    rows[np.arange(len(rows)), distance.argmin(axis=1)] = 1
    return rows
