"""Skinning weights from bone distances (paper section 3.2)."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple, Unpack

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..animation.falloff.adjustments import Adjustments
from ..animation.falloff.pipeline import RigFalloff
from ..errors import ParameterError, WeightsError
from ..geodesics import BoneDistances
from ..geodesics.allowed import check_allowed
from ..method import ANIMATION, Method, MethodName, WeightOptions, method_of
from ..rig.rows import chosen_entries, rows_of_entries, scaled, single, to_dense, with_rows
from ..runtime.progress import Progress, share_of, silent
from .paper_kernel import paper_kernel
from .prune import prune


def skinning_weights(
    distances: BoneDistances,
    *,
    method: Method | MethodName = ANIMATION,
    allowed: NDArray[np.bool_] | None = None,
    adjustments: Adjustments | None = None,
    progress: Progress = silent,
    **options: Unpack[WeightOptions],
) -> NDArray[np.float64]:
    """Turn distances into weights.

    Parameters
    ----------
    distances : BoneDistances
    method : Method, "animation" or "paper"
        Its falloff, alpha, greatest number of influences and threshold count here. `distances`
        must be those of enough joints for it.
    allowed : array, shape (n, j), bool, optional
        Which joints each vertex may follow; see `Rig.allowed`.
    adjustments : Adjustments, optional
        Arrays that `bind` makes of the gains and radii in `Computed`.
    progress : callable
        See `cutcell.runtime.progress`; the stage is called "weights".
    **options
        Single options of the method: `falloff` ("paper" is equation 1, "rig" is made to animate
        with, see docs/falloff.md), `alpha`, `max_influences`, `threshold`.

    Returns
    -------
    array, shape (n, j), float64
        Not negative, finite, rows sum to one.

    Raises
    ------
    ParameterError
        A parameter is out of its range, or the distances are of too few joints.
    WeightsError
        `allowed` has the wrong shape, or leaves a vertex only joints without a distance.

    References
    ----------
    Paper section 3.2, equation 1.
    """
    method = method_of(method, **options)
    measured, needed = distances.nearest_joints, method.joints_needed
    if method.falloff == "paper":
        needed = method.max_influences  # fewer than are measured by default, if that is wanted
    if measured is not None and (needed is None or needed > measured):
        raise ParameterError(
            f"max_influences is {method.max_influences}, but the distances were measured from the "
            f"{measured} nearest joints of each vertex alone: measure them again with this method"
        )

    if allowed is not None:
        deform = np.isin(np.arange(distances.rows.shape[1]), distances.bones.joint)
        allowed = check_allowed(distances.graph, deform, allowed)
    steps = weight_steps(distances, method, allowed, adjustments, progress=progress)
    return last_of(steps).toarray()


class WeightStep(NamedTuple):
    """A step from distances to weights, and the weights after it: (n, j), or (k, j) if `welded`."""

    name: str
    weights: csr_array
    welded: bool = False


LIMIT_LABELS = {"storable": "storable in file", "limit": "limited", "normalise": "normalised"}
"""Labels of the steps after the falloff."""


def weight_steps(
    distances: BoneDistances,
    method: Method,
    allowed: NDArray[np.bool_] | None = None,
    adjustments: Adjustments | None = None,
    falloff: RigFalloff | None = None,
    progress: Progress = silent,
    scaled: bool = True,
) -> Iterator[WeightStep]:
    """Compute weights from distances, and yield those after each step.

    The falloff "rig" is computed if left out. If not `scaled`, the largest weights of each vertex
    stay as they are: then fewer can be kept later, and scaled, with the very result of keeping
    fewer at once.

    Shapes: allowed (n, j), see `skinning_weights`.
    """
    graph, priority = distances.graph, _by_position(distances)

    def report(done: float) -> None:
        progress("weights", done)

    def limited(weights: csr_array) -> csr_array:
        most, threshold, part = method.max_influences, method.threshold, share_of(report, 0.8, 1)
        return prune(weights, most, threshold, priority, part, scaled)

    if method.falloff == "paper":
        weights = equation_1(distances, method, allowed, adjustments)
        yield WeightStep("falloff", weights, allowed is None)
    else:
        # A falloff that was not given is large, and is gone after its steps.
        for name, weights in (falloff or RigFalloff.over(distances, adjustments)).steps(report):
            yield WeightStep(name, weights, welded=True)
    if allowed is None:
        weights = limited(weights)[graph.vertex_node]
    else:
        if method.falloff != "paper":
            weights = weights[graph.vertex_node]
        weights = permit(weights, distances, allowed)
        yield WeightStep("storable", weights)
        weights = limited(weights)
    yield WeightStep("normalise", weights)


def last_of(steps: Iterator[WeightStep]) -> csr_array:
    """Run all steps; return the weights after the last."""
    return deque(steps, maxlen=1).pop().weights


def equation_1(
    distances: BoneDistances,
    method: Method,
    allowed: NDArray[np.bool_] | None = None,
    adjustments: Adjustments | None = None,
) -> csr_array:
    """Apply the paper's falloff to the distances, see `paper_kernel`.

    Shapes: allowed (n, j); returns (n, j) with `allowed`, else (k, j) of welded vertices.
    """
    assert method.alpha is not None
    distance = to_dense(distances.rows).T if allowed is None else distances.joint
    if adjustments is not None:
        distance = distance / adjustments.gain[:, None]
    return csr_array(paper_kernel(distance, distances.graph.lattice.diagonal, method.alpha))


def permit(weights: csr_array, distances: BoneDistances, allowed: NDArray[np.bool_]) -> csr_array:
    """Drop what a vertex may not follow; one left with nothing follows its nearest joint.

    Shapes: weights, allowed (n, j); returns (n, j).
    """
    is_allowed = allowed[rows_of_entries(weights), weights.indices]
    permitted = chosen_entries(weights, is_allowed)
    lost = np.flatnonzero(permitted.sum(axis=1) == 0)
    distance = np.where(allowed[lost].T, distances.at(slice(None), lost), np.inf)
    if np.isinf(distance.min(axis=0)).any():
        raise WeightsError("no joint that a vertex may follow was measured; measure by `allowed`")
    permitted = with_rows(permitted, lost, single(distance.argmin(axis=0), allowed.shape[1]))
    return scaled(permitted, 1 / permitted.sum(axis=1))


def keep_strongest(
    distances: BoneDistances,
    weights: csr_array,
    max_influences: int | None = ANIMATION.max_influences,
    threshold: float = ANIMATION.threshold,
) -> csr_array:
    """Keep the largest weights of each vertex: the last step of `skinning_weights`.

    Weights of many influences can be kept, and pruned again as often as that is changed.

    Parameters
    ----------
    distances : BoneDistances
        Distances that the weights were computed from.
    weights : csr_array, shape (n, j)
        Rows sum to one.
    max_influences, threshold
        See `Method`.

    Returns
    -------
    csr_array, shape (n, j)
        Rows sum to one.

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    method = Method(max_influences=max_influences, threshold=threshold)
    return prune(weights, method.max_influences, method.threshold, _by_position(distances))


def _by_position(distances: BoneDistances) -> NDArray[np.intp]:
    """Order the joints by where they are, so that ties do not depend on their numbers."""
    positions = np.full((distances.rows.shape[1], 3), np.inf)
    positions[distances.bones.joint] = distances.bones.start
    return distances.graph.lattice.order(positions)
