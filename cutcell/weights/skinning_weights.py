"""Skinning weights from bone distances (paper section 3.2)."""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..errors import ParameterError, WeightsError
from ..geodesics import BoneDistances
from ..geodesics.allowed import check_allowed
from ..method import ANIMATION, Method, MethodName, WeightOptions, method_of
from ..runtime.progress import Progress, share_of, silent
from .adjustments import Adjustments
from .context import Context, Step, run
from .paper_kernel import paper_kernel
from .prune import prune
from .rig_falloff.pipeline import RIG_STEPS
from .rig_falloff.surface_operators import SurfaceOperators
from .rows import rows_of_entries, scaled, single, with_data, with_rows


def skinning_weights(
    distances: BoneDistances,
    *,
    method: Method | MethodName = ANIMATION,
    allowed: NDArray[np.bool_] | None = None,
    adjustments: Adjustments | None = None,
    surface: SurfaceOperators | None = None,
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
    surface : SurfaceOperators, optional
        Operators of the graph's mesh; computed when left out.
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

    graph = distances.graph
    if allowed is not None:
        deform = np.isin(np.arange(len(distances.at_welded)), distances.bones.joint)
        allowed = check_allowed(graph, deform, allowed)
    context = Context(method, allowed, progress, graph, distances, adjustments, surface)
    return run(weight_steps(method, allowed), context).weights.toarray()


def weight_steps(method: Method, allowed: NDArray[np.bool_] | None = None) -> tuple[Step, ...]:
    """List the steps from distances to weights, in their order.

    Shapes: allowed (n, j), see `skinning_weights`.
    """
    falloff: tuple[Step, ...] = (
        (Step("falloff", equation_1),) if method.falloff == "paper" else RIG_STEPS
    )
    expand, normalise = Step("vertices", per_vertex), Step("normalise", limit)
    if allowed is None:
        return (*falloff, normalise, expand)
    return (*falloff, expand, Step("storable", permit), normalise)  # welded vertices may differ


def equation_1(context: Context) -> csr_array:
    """Apply the paper's falloff to the distances, see `paper_kernel`."""
    distances, alpha = context.distances, context.method.alpha
    assert alpha is not None
    context.is_per_vertex = context.allowed is not None
    distance = distances.joint if context.is_per_vertex else distances.at_welded
    if context.adjustments is not None:
        distance = distance / context.adjustments.gain[:, None]
    return csr_array(paper_kernel(distance, context.graph.lattice.diagonal, alpha))


def permit(context: Context) -> csr_array:
    """Drop what a vertex may not follow; one left with nothing follows its nearest joint."""
    assert context.allowed is not None
    weights, allowed = context.weights, context.allowed
    is_allowed = allowed[rows_of_entries(weights), weights.indices]
    permitted = with_data(weights, weights.data * is_allowed)
    lost = np.flatnonzero(permitted.sum(axis=1) == 0)
    distance = np.where(allowed[lost].T, context.distances.at(slice(None), lost), np.inf)
    if np.isinf(distance.min(axis=0)).any():
        raise WeightsError("no joint that a vertex may follow was measured; measure by `allowed`")
    permitted = with_rows(permitted, lost, single(distance.argmin(axis=0), allowed.shape[1]))
    return scaled(permitted, 1 / permitted.sum(axis=1))


def limit(context: Context) -> csr_array:
    """Keep the largest weights of each vertex."""
    most, threshold = context.method.max_influences, context.method.threshold
    order = _by_position(context.distances)
    report = share_of(context.report, 0.8, 1)
    return prune(context.weights, most, threshold, order, report, context.scaled)


def per_vertex(context: Context) -> csr_array:
    """Return the weights of all vertices, from those of welded ones."""
    if context.is_per_vertex:
        return context.weights
    context.is_per_vertex = True
    return context.weights[context.graph.vertex_node]


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
    positions = np.full((len(distances.at_welded), 3), np.inf)
    positions[distances.bones.joint] = distances.bones.start
    return distances.graph.lattice.order(positions)
