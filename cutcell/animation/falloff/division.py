"""The surface divided among joints by distance: where weights for rigs begin (docs/falloff.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from ...geodesics import BoneDistances, Bones
from ...geometry.vectors import TIE, segment_fraction
from ...runtime.compiled import no_refcount
from .adjustments import Adjustments
from .containment import cross_component_penalty, joint_containment
from .surface_operators import SurfaceOperators

POWER = 30
"""A vertex belongs to its nearest joint; another that is 10 % farther counts a seventeenth."""
FACING_LEAST = 0.3
"""Surface covers the bones that it looks away from. The distance of a bone that it looks right at
is divided by this, that of one that it looks away from by 1."""
MIN_CELLS = 0.01
"""Lattice cells: distances that are all shorter are equal."""
RADIUS_FACTOR = 1.5
"""Surface that is this many times as far from a bone as the median of that bone's surface is not
about that bone. The edges of a square bar are 1.41 times as far as the middle of its sides."""
MIN_RADIUS = 0.5
"""Lattice cells: no bone has a smaller radius than this."""
CONNECTED = 0.02
"""Part of the longest side: a bone that ends this near to the start of another joint's bone leads
on to it."""
MANY = 200_000
"""Vertices whose distances are sorted to measure radii; of more, these are a sample."""
MIN_SHARE = 1e-3
"""Smallest share of a joint at a vertex of that joint's surface."""


@dataclass(frozen=True, eq=False)
class Division:
    """A surface divided among joints, and by what.

    Parameters
    ----------
    distances : BoneDistances
    surface : SurfaceOperators
        The surface of their graph.
    containment, penalty : arrays, shape (components, j)
        See `joint_containment`, and `cross_component_penalty`, which adjustments change.
    radius : array, shape (j,)
        Beyond which a joint's distances grow by their square.
    beyond : array, shape (k,), bool
        Which vertices have a share of a joint beyond its radius.
    weights : array, shape (k, j)
        The share of each joint. Rows sum to one.
    """

    distances: BoneDistances
    surface: SurfaceOperators
    containment: NDArray[np.float64]
    penalty: NDArray[np.float64]
    radius: NDArray[np.float64]
    beyond: NDArray[np.bool_]
    weights: NDArray[np.float64]

    @classmethod
    def by(
        cls,
        distances: BoneDistances,
        surface: SurfaceOperators,
        adjustments: Adjustments | None = None,
        before: Division | None = None,
    ) -> Division:
        """Divide a surface by distances: first without radii, which are measured of what results.

        Where distances are the same as those `before`, which is of the same surface, its weights
        are taken over.
        """
        joints, vertices = distances.at_welded.shape
        containment, owned = joint_containment(surface, distances.bones, distances.skeleton, joints)
        penalty = cross_component_penalty(containment, owned)
        distance = distances.at_welded
        if adjustments is not None:
            penalty = penalty / adjustments.gain
        if before is None:
            weights, chosen = np.zeros((vertices, joints)), np.ones(vertices, np.bool_)
        else:
            weights = before.weights.copy()
            chosen = before.beyond | (distance != before.distances.at_welded).any(axis=0)
            chosen |= (penalty != before.penalty).any(axis=1)[surface.component]
        _divide(distances, surface, penalty, np.full(joints, np.inf), chosen, weights)
        resolution = distances.graph.lattice.resolution
        radius = _radii(weights, distance, surface.areas, distances.bones, resolution)
        if adjustments is not None:
            radius = np.where(np.isnan(adjustments.radius), radius, adjustments.radius)
        beyond = np.zeros(vertices, np.bool_)
        for j in np.flatnonzero(np.isfinite(radius)):
            beyond |= (distance[j] > radius[j]) & (weights[:, j] > MIN_SHARE)
        _divide(distances, surface, penalty, radius, beyond, weights)
        return cls(distances, surface, containment, penalty, radius, beyond, weights)


def _divide(
    distances: BoneDistances,
    surface: SurfaceOperators,
    penalty: NDArray[np.float64],
    radius: NDArray[np.float64],
    chosen: NDArray[np.bool_],
    weights: NDArray[np.float64],
) -> None:
    """Divide chosen vertices (k,) among joints: write their weights (k, j)."""
    bones = distances.bones
    _divide_by_distance(
        surface.points,
        surface.normals,
        distances.at_welded,
        penalty,
        surface.component,
        np.searchsorted(bones.joint, np.arange(len(radius) + 1)),
        bones.start,
        bones.end,
        MIN_CELLS / distances.graph.lattice.resolution,
        radius,
        chosen,
        weights,
    )


@no_refcount
def _divide_by_distance(
    points, normals, distance, penalty, component, bone, start, end, near, radius, chosen, weights
):
    """Divide chosen vertices among joints by distance; `bone` holds the first bone of each joint.

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
def _facing(point, normal, start, end, first, last):
    """Return how much a surface looks away from the nearest of some bones, `FACING_LEAST` to 1."""
    nearest, cosine = np.inf, 0.0
    for b in range(first, last):
        t = segment_fraction(start[b], end[b], point)
        length, out = 0.0, 0.0
        for c in range(3):
            displacement = point[c] - start[b, c] - t * (end[b, c] - start[b, c])
            length += displacement * displacement
            out += displacement * normal[c]
        length = np.sqrt(length)
        if length < nearest + TIE:
            out = out / length if length > TIE else 0.0
            cosine = out if length < nearest - TIE else max(out, cosine)
            nearest = min(length, nearest)
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
    step = -(-len(weights) // MANY)
    weights, distance, areas = weights[::step], distance[:, ::step], areas[::step]
    entry = np.flatnonzero(weights > MIN_SHARE)
    vertex, joint = np.divmod(entry, len(distance))
    length, area = distance[joint, vertex], weights.ravel()[entry] * (areas[vertex] + 1e-12)
    # By joint, then by length: one sort of sums takes a third of the time of two sorts.
    order = np.argsort(joint * (1 + length.max(initial=0.0)) + length, kind="stable")
    joint, length, total = joint[order], length[order], np.cumsum(area[order])
    first = np.searchsorted(joint, np.arange(len(distance) + 1))
    before = np.concatenate([[0.0], total])[first]
    middle = (before[:-1] + before[1:]) / 2 - TIE * before[-1]
    median = np.maximum(np.searchsorted(total, middle), first[:-1])
    radius = np.full(len(distance), np.inf)
    measured = _leads_on(bones, len(distance)) & (first[1:] > first[:-1])
    least = MIN_RADIUS / resolution
    radius[measured] = RADIUS_FACTOR * np.maximum(length[median[measured]], least)
    return radius


def facing(
    point: NDArray[np.float64], normal: NDArray[np.float64], bones: Bones, joint: int
) -> float:
    """Return how much surface at a point faces away from a joint's bones, `FACING_LEAST` to 1.

    Distances are divided by this: a bone in front of the skin, as of another limb, is
    treated as farther.
    """
    first, last = np.searchsorted(bones.joint, [joint, joint + 1])
    return float(_facing(point, normal, bones.start, bones.end, first, last))


def _leads_on(bones: Bones, joints: int) -> NDArray[np.bool_]:
    """Return which joints have a bone that ends where one of another joint begins."""
    meets = cdist(bones.end, bones.start, "chebyshev") < CONNECTED
    meets &= bones.joint[:, None] != bones.joint
    leads = np.zeros(joints, np.bool_)
    leads[bones.joint[meets.any(axis=1)]] = True
    return leads
