"""The surface divided among joints by distance: where weights for rigs begin (docs/falloff.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial.distance import cdist

from ...geodesics import BoneDistances, Bones
from ...geometry.vectors import TIE, segment_fraction
from ...rig.rows import rows_of_entries
from ...runtime.compiled import no_refcount
from .adjustments import Adjustments
from .containment import cross_component_penalty, joint_containment

POWER = 30
"""A vertex belongs to its nearest joint; another that is 10 % farther counts a seventeenth."""
FACING_LEAST = 0.3
"""Surface covers the bones that it looks away from. The distance of a bone that it looks right at
is divided by this, that of one that it looks away from by 1."""
EQUAL_CELLS = 0.01
"""Lattice cells: distances that are all shorter are equal."""
RADIUS_FACTOR = 1.5
"""Surface that is this many times as far from a bone as the median of that bone's surface is not
about that bone. The edges of a square bar are 1.41 times as far as the middle of its sides."""
MIN_RADIUS = 0.5
"""Lattice cells: no bone has a smaller radius than this."""
CONNECTED = 0.02
"""Part of the longest side: a bone that ends this near to the start of another joint's bone leads
on to it."""
MAX_MEASURED = 200_000
"""Vertices whose distances are sorted to measure radii; of more, these are a sample."""
OWN_SHARE = 1e-3
"""Smallest share of a joint at a vertex of that joint's surface."""


@dataclass(frozen=True, eq=False)
class Division:
    """A surface divided among joints, and by what.

    Parameters
    ----------
    containment, penalty : arrays, shape (components, j)
        See `joint_containment`, and `cross_component_penalty`, which adjustments change.
    radius : array, shape (j,)
        Beyond which a joint's distances grow by their square.
    beyond : array, shape (k,), bool
        Which vertices have a share of a joint beyond its radius.
    weights : csr_array, shape (k, j)
        The share of each joint that was measured. Rows sum to one.
    """

    containment: NDArray[np.float64]
    penalty: NDArray[np.float64]
    radius: NDArray[np.float64]
    beyond: NDArray[np.bool_]
    weights: csr_array

    @classmethod
    def by(
        cls,
        distances: BoneDistances,
        adjustments: Adjustments | None = None,
    ) -> Division:
        """Divide a surface by distances: at first without radii, which the result has measured."""
        rows, bones, surface = distances.rows, distances.bones, distances.graph.mesh
        vertices, joints = rows.shape
        containment, owned = joint_containment(surface, bones, distances.skeleton, joints)
        penalty = cross_component_penalty(containment, owned)
        if adjustments is not None:
            penalty = penalty / adjustments.gain
        resolution = distances.graph.lattice.resolution
        share = np.empty(len(rows.data))

        def divide(radius: NDArray[np.float64], chosen: NDArray[np.intp]) -> None:
            _divide_by_distance(
                surface.points,
                surface.normals,
                rows.indptr,
                rows.indices,
                rows.data,
                penalty,
                surface.component,
                np.searchsorted(bones.joint, np.arange(joints + 1)),
                bones.start,
                bones.end,
                EQUAL_CELLS / resolution,
                radius,
                chosen,
                share,
            )

        divide(np.full(joints, np.inf), np.arange(vertices))
        weights = csr_array((share, rows.indices, rows.indptr), rows.shape)
        few = slice(None, None, -(-vertices // MAX_MEASURED))
        radius = _radii(weights[few], rows[few].data, surface.areas[few], bones, resolution)
        if adjustments is not None:
            radius = np.where(np.isnan(adjustments.radius), radius, adjustments.radius)
        is_beyond = (rows.data > radius[rows.indices]) & (share > OWN_SHARE)
        beyond = np.bincount(rows_of_entries(rows)[is_beyond], minlength=vertices) > 0
        divide(radius, np.flatnonzero(beyond))
        return cls(containment, penalty, radius, beyond, weights)


@no_refcount
def _divide_by_distance(
    points, normals, begin, joint, distance, penalty, component, bone, start, end, near, radius,
    chosen, share,
):  # fmt: skip
    """Divide chosen vertices among joints by distance; `bone` holds the first bone of each joint.

    Distances up to `near` are equal; beyond a joint's `radius` they grow by their square.
    """
    for v in chosen:
        least = np.inf
        for e in range(begin[v], begin[v + 1]):
            j = joint[e]
            effective = penalty[component[v], j] * max(distance[e], near)
            effective *= max(1.0, distance[e] / radius[j])
            effective /= _facing(points[v], normals[v], start, end, bone[j], bone[j + 1])
            share[e] = effective
            least = min(least, effective)
        total = 0.0
        for e in range(begin[v], begin[v + 1]):
            share[e] = (least / share[e]) ** POWER
            total += share[e]
        for e in range(begin[v], begin[v + 1]):
            share[e] /= total


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
    weights: csr_array,
    distance: NDArray[np.float64],
    areas: NDArray[np.float64],
    bones: Bones,
    resolution: int,
) -> NDArray[np.float64]:
    """Measure up to which distance the surface is about each joint's bones, shape (j,).

    A neck's surface lies all around it at about one distance: what is much farther, such as a
    chin, is not the neck's even if no other bone is nearer. Where a leaf bone ends is only a
    guess, so that its surface may be at any distance: its radius is infinite.

    Shapes: weights (k, j), distance (e,) of each entry, areas (k,).
    """
    vertex, joints = rows_of_entries(weights), weights.shape[1]
    entry = np.flatnonzero(weights.data > OWN_SHARE)
    vertex, joint = vertex[entry], weights.indices[entry]
    length, area = distance[entry], weights.data[entry] * (areas[vertex] + 1e-12)
    # By joint, then by length: one sort of sums takes a third of the time of two sorts.
    order = np.argsort(joint * (1 + length.max(initial=0.0)) + length, kind="stable")
    joint, length, total = joint[order], length[order], np.cumsum(area[order])
    first = np.searchsorted(joint, np.arange(joints + 1))
    before = np.concatenate([[0.0], total])[first]
    middle = (before[:-1] + before[1:]) / 2 - TIE * before[-1]
    median = np.maximum(np.searchsorted(total, middle), first[:-1])
    radius = np.full(joints, np.inf)
    measured = _leads_on(bones, joints) & (first[1:] > first[:-1])
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
