"""Refine weights: smoothing, symmetry, and joints whose weights an artist has painted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..geometry.edges import find_edges
from ..geometry.weld import WELD_TOLERANCE, weld
from ..method import ANIMATION, Method, MethodName, method_of
from ..rig import Rig, TriangleMesh
from ..rig.checks import check_flag, check_integer
from ..weights.context import Context, Step, run
from ..weights.prune import prune
from .locks import lock_joints, locked_joints
from .symmetry import balance, find_mirror, mirror_weights

MAX_PASSES = 1000
STEP = 0.5
"""Part of the way to its neighbours that a pass moves a vertex; half of it never oscillates."""


def smooth_weights(
    mesh: TriangleMesh, weights: NDArray[np.float64], passes: int
) -> NDArray[np.float64]:
    """Average weights with those of the neighbours along mesh edges, again and again.

    Vertices are welded first, so seams stay closed. Nothing flows between components that
    no edge joins, however close they are.

    Shapes: weights (n, j); returns (n, j).
    """
    side = np.ptp(mesh.bounds, axis=0).max()
    welded = weld(mesh.vertices, WELD_TOLERANCE * side)[1]
    step = _step(welded[mesh.faces], int(welded.max()) + 1)
    smoothed = csr_array(_gather(welded)) @ weights
    for _ in range(passes):
        smoothed = step @ smoothed
    return smoothed[welded]


def _gather(welded: NDArray[np.int32]) -> csr_array:
    """Average the vertices that are welded to one."""
    count = np.bincount(welded)
    entries = (1 / count[welded], (welded, np.arange(len(welded))))
    return csr_array(entries, shape=(len(count), len(welded)))


def _step(faces: NDArray[np.int32], vertices: int) -> csr_array:
    """Return one pass as a matrix: half the vertex, half the mean of its neighbours."""
    low, high = find_edges(faces).edges.T
    start, end = np.concatenate([low, high]), np.concatenate([high, low])
    degree = np.bincount(start, minlength=vertices)
    stay = np.where(degree > 0, 1 - STEP, 1.0)
    rows = np.concatenate([start, np.arange(vertices)])
    columns = np.concatenate([end, np.arange(vertices)])
    values = np.concatenate([STEP / degree[start], stay])
    return csr_array((values, (rows, columns)), shape=(vertices, vertices))


class RefineOptions(TypedDict, total=False):
    """Options of `refine_weights`."""

    smoothing: int
    symmetric: bool
    locked: Sequence[int | str]


class Pruning(TypedDict, total=False):
    """Options of a `Method` that `refine_weights` follows."""

    max_influences: int | None
    threshold: float


def refine_weights(
    rig: Rig,
    weights: NDArray[np.float64],
    *,
    method: Method | MethodName = ANIMATION,
    smoothing: int = 0,
    symmetric: bool = False,
    locked: Sequence[int | str] = (),
    **options: Unpack[Pruning],
) -> NDArray[np.float64]:
    """Smooth weights, mirror them, and put back those of locked joints: in this order.

    Parameters
    ----------
    rig : Rig
    weights : array, shape (n, j)
        Rows sum to one.
    method : Method, "animation" or "paper"
        Its greatest number of influences and threshold hold again after smoothing and mirroring.
    smoothing : int
        Passes over the mesh; see `smooth_weights`.
    symmetric : bool
        Left and right get the same; see `find_mirror`.
    locked : sequence of int or str
        Joints that keep the rig's own weights; see `lock_joints`.
    **options
        Single options of the method: `max_influences`, `threshold`.

    Returns
    -------
    array, shape (n, j)
        Rows sum to one; `weights` itself if all options are off.

    Raises
    ------
    ParameterError, MeshError, WeightsError
        An option is out of range, or the rig does not allow it.
    """
    context = Context(method_of(method, **options), weights=weights)
    return run(refinement_steps(rig, smoothing, symmetric, locked), context).weights


def refinement_steps(
    rig: Rig, smoothing: int = 0, symmetric: bool = False, locked: Sequence[int | str] = ()
) -> list[Step]:
    """List the steps of `refine_weights`; check its options."""
    smoothing = check_integer("smoothing", smoothing, 0, MAX_PASSES)
    mirror = find_mirror(rig) if check_flag("symmetric", symmetric) else None
    is_locked = locked_joints(rig, locked)
    steps = []
    if smoothing:
        steps.append(Step("smooth", lambda c: smooth_weights(rig.mesh, c.weights, smoothing)))
    if mirror is not None:
        steps.append(Step("mirror", lambda c: mirror_weights(c.weights, mirror)))
    if steps:
        steps.append(Step("prune", lambda c: _prune(rig, c.weights, c.method)))
    if mirror is not None:
        steps.append(Step("balance", lambda c: balance(c.weights, mirror)))
    if is_locked.any():
        steps.append(
            Step("lock", lambda c: lock_joints(rig, c.weights, locked, c.method.max_influences))
        )
    return steps


def _prune(rig: Rig, weights: NDArray[np.float64], method: Method) -> NDArray[np.float64]:
    """Keep the largest weights (n, j) that the file can store."""
    order = np.lexsort(rig.skeleton.joints.T)
    return prune(_permitted(rig, weights), method.max_influences, method.threshold, order)


def _permitted(rig: Rig, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Remove weights that the file cannot store, unless a row would be left empty."""
    if rig.allowed is None:
        return weights
    storable = np.where(rig.allowed, weights, 0.0)
    total = storable.sum(axis=1, keepdims=True)
    return np.divide(storable, total, out=weights.copy(), where=total > 0)
