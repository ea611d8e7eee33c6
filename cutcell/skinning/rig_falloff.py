"""The falloff for rigs: weights that animate well, from geodesic distances (docs/falloff.md)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from ..compiled import no_refcount
from ..geodesics import BoneDistances, Bones
from ..method import RIG_REACH
from ..progress import Tell, share_of
from ..threads import run_parallel
from .adjustments import Adjustments
from .containment import cross_component_penalty, joint_containment, make_rigid
from .diffusion import Diffusion
from .rigid_accessories import attach_accessories
from .surface_operators import SurfaceOperators

POWER = 20
"""A vertex belongs to its nearest joint; another that is 10 % farther counts a seventh."""
FACING_LEAST = 1 / RIG_REACH
"""Surface covers the bones that it looks away from. The distance of a bone that it looks right at
is divided by this, that of one that it looks away from by 1."""
LEAST_CELLS = 0.01
"""Lattice cells: distances that are all shorter are equal."""
RADIUS_FACTOR = 1.5
"""Surface that is this many times as far from a bone as the median of that bone's surface is not
about that bone. The edges of a square bar are 1.41 times as far as the middle of its sides."""
LEAST_RADIUS = 0.5
"""Lattice cells: no bone has a smaller radius than this."""
CONNECTED = 0.02
"""Of the longest side: a bone that ends as near as this to where another joint's bone begins leads
on to it."""
LEAST_SHARE = 1e-3
"""A vertex with a smaller share of a joint does not count as that joint's surface."""
TAIL = 0.05
"""Of a vertex' largest weight: subtracted from all its weights, so that they end somewhere."""


Record = Callable[[str, NDArray], None]
"""Is told the name of each step and what it has computed, which may change afterwards."""


def rig_weights(
    distances: BoneDistances,
    surface: SurfaceOperators,
    tell: Tell = lambda done: None,
    record: Record = lambda step, array: None,
    adjustments: Adjustments | None = None,
    diffusion: Diffusion | None = None,
) -> NDArray[np.float64]:
    """Turn distances into weights for animation.

    Parameters
    ----------
    distances : BoneDistances
        Best with bones fitted to the body, `leaf="fit"`.
    surface : SurfaceOperators
        Of their graph.
    tell : callable
        See `progress.Tell`.
    record : callable
        See `Record`: "penalty" (components, j), "radius" (j,), "beyond" (k,), which vertices have
        a share of a joint beyond its radius; and weights (k, j) after the steps "falloff",
        "spread" and "rigid".
    adjustments : Adjustments, optional
    diffusion : Diffusion, optional
        To spread by, in place of that of these distances.

    Returns
    -------
    array, shape (k, j)
        Per welded vertex. Rows sum to one.
    """
    graph, bones = distances.graph, distances.bones
    distance, resolution = distances.at_welded, graph.lattice.resolution
    weights = np.zeros(distance.shape[::-1])

    def divide() -> NDArray[np.float64]:
        """Divide the surface among the joints: the right side of the equilibrium."""
        containment = joint_containment(surface, bones, len(distance))
        first_bone = np.searchsorted(bones.joint, np.arange(len(distance) + 1))
        penalty = cross_component_penalty(containment)
        if adjustments is not None:
            penalty = penalty / adjustments.gain
        known = surface.points, surface.normals, distance, penalty, surface.component
        ends = first_bone, bones.start, bones.end, LEAST_CELLS / resolution
        unbounded, chosen = np.full(len(distance), np.inf), np.ones(len(weights), np.bool_)
        _divide_by_distance(*known, *ends, unbounded, chosen, weights)
        radius = _radii(weights, distance, surface.areas, bones, resolution)
        if adjustments is not None:
            radius = np.where(np.isnan(adjustments.radius), radius, adjustments.radius)
        _mark_beyond(distance, weights, radius, chosen)
        _divide_by_distance(*known, *ends, radius, chosen, weights)
        for step, array in (("penalty", penalty), ("radius", radius), ("beyond", chosen)):
            record(step, array)
        return containment

    def prepare() -> Diffusion:
        if diffusion is not None:
            return diffusion
        return Diffusion.over(surface, distance.min(axis=0), resolution, share_of(tell, 0, 0.5))

    containment, spreading = run_parallel(divide, prepare)
    record("falloff", weights)
    weights = spreading.spread(weights, share_of(tell, 0.5, 1))
    record("spread", weights)
    by_itself = None if adjustments is None else adjustments.by_itself
    if len(containment) > 1:
        weights = make_rigid(containment, surface.component, weights, by_itself)
    weights = attach_accessories(graph, surface, containment, weights, by_itself)
    record("rigid", weights)
    _subtract_tail(weights)
    return weights


@no_refcount
def _divide_by_distance(
    points,
    normals,
    distance,
    penalty,
    component,
    bone,
    start,
    end,
    near,
    radius,
    chosen,
    weights,
):
    """Divide chosen vertices among joints by distance; `bone` tells where each joint's bones begin.

    Distances up to `near` are equal; beyond a joint's `radius` they grow by their square.
    """
    for v in range(len(points)):
        if not chosen[v]:
            continue
        least = np.inf
        for j in range(len(distance)):
            weights[v, j] = 0.0
            if distance[j, v] == np.inf:
                continue
            effective = penalty[component[v], j] * max(distance[j, v], near)
            effective *= max(1.0, distance[j, v] / radius[j])
            effective /= _facing(points[v], normals[v], start, end, bone[j], bone[j + 1])
            weights[v, j] = effective
            least = min(least, effective)
        total = 0.0
        for j in range(len(distance)):
            if distance[j, v] < np.inf:
                weights[v, j] = (least / weights[v, j]) ** POWER
                total += weights[v, j]
        for j in range(len(distance)):
            weights[v, j] /= total


@no_refcount
def _mark_beyond(distance, weights, radius, found):
    """Mark the vertices, shape (k,), with a share of a joint that are beyond its radius."""
    for v in range(len(weights)):
        found[v] = False
        for j in range(len(distance)):
            if weights[v, j] > LEAST_SHARE and distance[j, v] > radius[j]:
                found[v] = True


@no_refcount
def _subtract_tail(weights):
    """Subtract a part of each vertex' largest weight from all of them, down to zero, in place."""
    for v in range(len(weights)):
        largest = 0.0
        for j in range(weights.shape[1]):
            largest = max(largest, weights[v, j])
        total = 0.0
        for j in range(weights.shape[1]):
            weights[v, j] = max(weights[v, j] - TAIL * largest, 0.0)
            total += weights[v, j]
        for j in range(weights.shape[1]):
            weights[v, j] /= total


@no_refcount
def _facing(point, normal, start, end, first, last):
    """Return how much a surface looks away from the nearest of some bones, `FACING_LEAST` to 1."""
    nearest, cosine = np.inf, 0.0
    for b in range(first, last):
        along, squared = 0.0, 0.0
        for c in range(3):
            along += (point[c] - start[b, c]) * (end[b, c] - start[b, c])
            squared += (end[b, c] - start[b, c]) ** 2
        t = min(max(along / squared, 0.0), 1.0) if squared > 0 else 0.0
        length, out = 0.0, 0.0
        for c in range(3):
            displacement = point[c] - start[b, c] - t * (end[b, c] - start[b, c])
            length += displacement * displacement
            out += displacement * normal[c]
        if length < nearest:
            nearest = length
            cosine = out / np.sqrt(length) if length > 0 else 0.0
    return FACING_LEAST + (1 - FACING_LEAST) * (1 + cosine) / 2


def _radii(
    weights: NDArray[np.float64],
    distance: NDArray[np.float64],
    areas: NDArray[np.float64],
    bones: Bones,
    resolution: int,
) -> NDArray[np.float64]:
    """Measure up to which distance the surface is about each joint's bones, shape (j,).

    A neck's surface lies all around it at about one distance: what is much farther, such as a
    chin, is not the neck's even if no other bone is nearer. Where a leaf bone ends is only a
    guess, so that its surface may be at any distance: its radius is infinite.
    """
    vertex, joint = np.nonzero(weights > LEAST_SHARE)
    length, area = distance[joint, vertex], weights[vertex, joint] * (areas[vertex] + 1e-12)
    order = np.lexsort((length, joint))
    joint, length, total = joint[order], length[order], np.cumsum(area[order])
    first = np.searchsorted(joint, np.arange(len(distance) + 1))
    before = np.concatenate([[0.0], total])[first]
    median = np.searchsorted(total, (before[:-1] + before[1:]) / 2)
    radius = np.full(len(distance), np.inf)
    known = _leads_on(bones, len(distance)) & (first[1:] > first[:-1])
    least = LEAST_RADIUS / resolution
    radius[known] = RADIUS_FACTOR * np.maximum(length[median[known]], least)
    return radius


def facing(
    point: NDArray[np.float64], normal: NDArray[np.float64], bones: Bones, joint: int
) -> float:
    """Return how much surface at a point looks away from a joint's bones, `FACING_LEAST` to 1.

    1 if it looks right at them: its distance is divided by this.
    """
    first, last = np.searchsorted(bones.joint, [joint, joint + 1])
    return float(_facing(point, normal, bones.start, bones.end, first, last))


def _leads_on(bones: Bones, joints: int) -> NDArray[np.bool_]:
    """Tell which joints have a bone that ends where another joint's begins."""
    meets = cdist(bones.end, bones.start, "chebyshev") < CONNECTED
    meets &= bones.joint[:, None] != bones.joint
    leads = np.zeros(joints, np.bool_)
    leads[bones.joint[meets.any(axis=1)]] = True
    return leads


def permitted(
    weights: NDArray[np.float64], distance: NDArray[np.float64], allowed: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Take away what a vertex may not follow; one left with nothing follows its nearest joint.

    Parameters
    ----------
    weights : array, shape (n, j)
    distance : array, shape (j, n)
    allowed : array, shape (n, j)

    Returns
    -------
    array, shape (n, j)
        Rows sum to one.
    """
    kept = np.where(allowed, weights, 0.0)
    lost = np.flatnonzero(kept.sum(axis=1) == 0)
    kept[lost, distance[:, lost].argmin(axis=0)] = 1
    return kept / kept.sum(axis=1, keepdims=True)
