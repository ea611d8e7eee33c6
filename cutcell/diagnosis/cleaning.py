"""Removal of weights that are implausible through the body."""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from ..animation.falloff.diffusion import MIN_DEPTH_CELLS
from ..animation.falloff.pipeline import WEIGHT_FLOOR
from ..binding import bind
from ..errors import WeightsError
from ..method import ANIMATION, check_resolution
from ..rig import Rig
from ..rig.inputs import RigLike, as_rig
from ..rig.mesh import vertex_shares
from ..runtime.compiled import compiled
from ..runtime.progress import Progress, silent
from ..runtime.threads import in_threads
from ..weights.prune import prune
from .subject import Subject
from .weights import INFLUENCES

NEAR_RATIO = 3.0
"""A joint is near a vertex if its distance is at most this multiple of the nearest joint's. From
2.5 to 6 the artists' weights that it was chosen on change by less than 0.01 (docs/clean.md); lower
values remove more."""
ATTACHED = 0.5
"""A joint with more than this share of a component's weight was attached on purpose."""
MIN_REMAINING = 0.5
"""With a smaller remaining share, a vertex is partly bound again."""
CHANGED = 1e-9
"""Shares of weight below this are rounding."""


@dataclass(frozen=True, eq=False)
class JointLoss:
    """Weight removed from one joint.

    Parameters
    ----------
    joint : int
    name : str
    share : float
        Share of all weight of the joint, 0 to 1; every welded vertex counts once.
    largest : float
        The largest weight removed from one vertex.
    vertices : array of int
        Vertices that lost weight of the joint.
    """

    joint: int
    name: str
    share: float
    largest: float
    vertices: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Cleaned:
    """Cleaned weights, and the removed weight.

    Parameters
    ----------
    weights : array, shape (n, j), float64
        Rows sum to what they summed to before.
    share : float
        Removed share of all weight, 0 to 1; every welded vertex counts once.
    losses : tuple of JointLoss
        Joints that lost weight, the largest share first.
    vertices : array of int
        Vertices whose weights changed.
    bound : array of int
        Those of them that lost more than half of their weight: that part comes from `bind`.
    """

    weights: NDArray[np.float64]
    share: float
    losses: tuple[JointLoss, ...]
    vertices: NDArray[np.intp]
    bound: NDArray[np.intp]


def clean(rig: RigLike, resolution: int = 64, *, progress: Progress = silent) -> Cleaned:
    """Remove weights that are implausible through the body, and keep the others.

    For weights of a network, of another program, or of a file: a hand's weight on the hip, an
    island of a joint's influence, noise. A weight is judged by two things. The distance through
    the body: a joint is near a vertex if it is at most three times as far as the nearest. And the
    skin: weight of a joint that is not near is kept as far as it is connected along mesh edges,
    at no lower level, with weight where the joint is near; or where the joint holds most of a
    connected component, as an accessory's does. What is left of a joint that is not near, and less
    than 5 % of the vertex's largest weight, ends there, as it does in `bind`.

    The other weights of the vertex grow in proportion. Where it lost more than half, the lost part
    is weighted as `bind` does.

    Parameters
    ----------
    rig : Rig, or anything else with weights that `bind` takes
    resolution : int
        R, as of `build_graph`.
    progress : callable
        See `cutcell.runtime.progress`; stages are "graph", "distances" and "weights".

    Returns
    -------
    Cleaned

    Raises
    ------
    WeightsError
        The rig has no weights.
    SkeletonError
        It has no joints.
    ParameterError, MeshError
        See `bind`.

    Examples
    --------
    >>> rig = cutcell.load("character.glb")  # doctest: +SKIP
    >>> cleaned = cutcell.clean(rig)  # doctest: +SKIP
    >>> for loss in cleaned.losses:  # doctest: +SKIP
    ...     print(loss.name, f"{loss.share:.1%} on {len(loss.vertices)} vertices")
    >>> cutcell.save("clean.glb", rig.with_weights(cleaned.weights))  # doctest: +SKIP
    """
    rig = as_rig(rig)
    resolution = check_resolution(resolution)
    rig.require_joints()
    weights = rig.weights
    if weights is None or not weights.any():
        raise WeightsError("the rig has no weights that could be cleaned; bind computes some")
    subject = Subject(rig, resolution, progress=progress)
    progress("weights", 0.0)
    remaining = _remaining(subject, weights)
    before, after = weights.sum(axis=1), remaining.sum(axis=1)
    few = np.flatnonzero(after < MIN_REMAINING * before)
    scale = np.divide(before, after, out=np.zeros_like(before), where=after > 0)
    is_less = after < before * (1 - CHANGED)
    cleaned = np.where(is_less[:, None], remaining * scale[:, None], weights)
    if len(few):
        method = ANIMATION.with_options(resolution=resolution)
        binding = bind(rig, method=method, graph=subject.graph)
        mixed = remaining[few] + (before - after)[few, None] * binding.rows[few].toarray()
        most = max(INFLUENCES, int((weights > 0).sum(axis=1).max()))
        total = mixed.sum(axis=1, keepdims=True)
        pruned = prune(csr_array(mixed / total), most, 0.0, np.arange(mixed.shape[1]))
        cleaned[few] = total * pruned.toarray()
    progress("weights", 1.0)
    changed = np.flatnonzero((cleaned != weights).any(axis=1))
    return Cleaned(cleaned, *_account(rig, weights - remaining), changed, few)


def _remaining(subject: Subject, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the remaining part of each weight, shape (n, j)."""
    welded, distances = subject.welded, subject.distances
    through = distances.of_all_joints(subject.progress).joint.T
    at_welded = np.zeros((len(subject.points), weights.shape[1]))
    np.maximum.at(at_welded, welded, weights)
    least = np.maximum(through.min(axis=1, keepdims=True), MIN_DEPTH_CELLS / subject.resolution)
    # Without a path, or with sources outside the body, distances are no evidence.
    is_near = (through <= NEAR_RATIO * least) | ~np.isfinite(through)
    is_near[:, ~subject.measurable] = True
    is_near[distances.fallback != 0] = True
    is_near |= _attached(subject, at_welded)[welded]
    anchored = np.zeros(at_welded.shape, bool)
    np.logical_or.at(anchored, welded, is_near)
    connected = connected_weights(at_welded, anchored, subject.edges.edges)
    remaining = np.where(is_near, weights, np.minimum(weights, connected[welded]))
    ends = ~is_near & (remaining < WEIGHT_FLOOR * weights.max(axis=1, keepdims=True))
    remaining[ends] = 0.0
    return remaining


def _attached(subject: Subject, weights: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which joints have most weight of each welded vertex's component, shape (k, j)."""
    component = subject.component
    sums = np.zeros((int(component.max()) + 1, weights.shape[1]))
    np.add.at(sums, component, weights)
    total = sums.sum(axis=1, keepdims=True)
    return np.asarray((sums > ATTACHED * total)[component])


def _account(rig: Rig, lost: NDArray[np.float64]) -> tuple[float, tuple[JointLoss, ...]]:
    """Return the removed share of all weight, and the joints that lost it."""
    assert rig.weights is not None
    shares = vertex_shares(rig.mesh)
    had, gone = shares @ rig.weights, shares @ lost
    losses = []
    for j in np.flatnonzero((lost > CHANGED).any(axis=0)):
        at = np.flatnonzero(lost[:, j] > CHANGED)
        share = gone[j] / had[j] if had[j] > 0 else 0.0
        name = rig.skeleton.names[j]
        losses.append(JointLoss(int(j), name, float(share), float(lost[at, j].max()), at))
    losses.sort(key=lambda loss: (-loss.share, loss.joint))
    return float(gone.sum() / had.sum()), tuple(losses)


def connected_weights(
    weights: NDArray[np.float64], anchored: NDArray[np.bool_], edges: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Lower weights to what is connected with anchored ones along edges.

    For each joint and vertex: of all paths along edges to a vertex where the joint is anchored,
    the one whose least weight is greatest; that least weight is kept (morphological reconstruction
    by dilation). An island keeps what the valley around it holds. Anchored weights stay.

    Shapes: weights (k, j), anchored (k, j), edges (e, 2); returns (k, j).

    References
    ----------
    Vincent 1993, "Morphological grayscale reconstruction in image analysis".
    """
    ends = np.concatenate([edges, edges[:, ::-1]])
    graph = coo_array((np.ones(len(ends), bool), tuple(ends.T)), shape=(len(weights),) * 2).tocsr()
    start, neighbour = graph.indptr.astype(np.int64), graph.indices.astype(np.int64)
    connected = np.where(anchored, weights, 0.0)
    # A joint whose weight is anchored everywhere needs no search.
    searched = np.flatnonzero((weights > connected).any(axis=0))

    def search(joint: int) -> None:
        column = np.ascontiguousarray(connected[:, joint])
        _spread(start, neighbour, np.ascontiguousarray(weights[:, joint]), column)
        connected[:, joint] = column

    in_threads(search, searched.tolist())
    return connected


@compiled
def _spread(start, neighbour, weight, connected):
    """Spread what is connected to neighbours, the greatest first, as Dijkstra's algorithm does."""
    queue = [(-connected[v], v) for v in range(len(weight)) if connected[v] > 0]
    queue.sort()  # a sorted list is a heap
    while len(queue) > 0:
        negative, v = heappop(queue)
        if -negative < connected[v]:
            continue  # more of it is connected on another path
        for e in range(start[v], start[v + 1]):
            other = neighbour[e]
            least = min(connected[v], weight[other])
            if least > connected[other]:
                connected[other] = least
                heappush(queue, (-least, other))
