"""Faults of the weights of a file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..geodesics import BoneDistances
from ..geodesics.fallback import REACHED
from ..geometry.segments import distance_to_segment
from ..runtime.display import shown_name
from .finding import Finding, count
from .subject import Subject

ROUNDING = 0.01
"""By how much weights may miss one: three weights of eight bits miss it by 0.006."""
INFLUENCES = 4
"""What game engines read."""
NOTICED = 0.05
"""A weight below it does not show."""
LEAP = 0.2
"""Part of the longest side: weight over paths this much longer through the body than straight
through the air, and than from the nearest joint, has leaked across a gap."""
FAR = 0.4
"""As far beyond the nearest joint it is out of place, whatever lies between."""
OUTSIDE = 0.05
"""Part of the longest side: joints farther from the body have no distances through it."""
DIFFERENT = 0.02
"""Weights of vertices in one place may differ by this much in total."""
SEAMS = 0.05
"""Part of all places on the surface: if more tear, it is no accident of a few layers."""
CLEANED = "remove weight that is implausible through the body from these vertices"
"""How weight that is too far from its joint is repaired."""
MAX_LINES = 40


def check_weights(subject: Subject) -> Iterator[Finding]:
    """Look for faults of the file's weights; a fresh character has none."""
    weights = subject.rig.weights
    if weights is None or not len(subject.rig.skeleton.joints):
        return
    yield from _numbers(subject, weights)
    yield from _torn(subject, weights)
    if subject.distances is not None:
        yield from _leaked(subject, subject.distances, weights)


def _numbers(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    sums = subject.rig.weight_sums
    sums = weights.sum(axis=1) if sums is None else sums
    invalid = np.flatnonzero(np.isnan(sums))
    if len(invalid):
        yield Finding(
            "invalid-weights",
            "error",
            f"{count(len(invalid), 'vertex', 'have')} weights in the file that are negative or no "
            "numbers; these count as none.",
            "Paint or compute them anew.",
            vertices=invalid,
            repair="leave these weights out, and scale the others to sum to one",
        )
    empty = np.flatnonzero((weights.sum(axis=1) == 0) & subject.is_used)
    if len(empty):
        yield Finding(
            "unweighted-vertices",
            "error",
            f"{count(len(empty), 'vertex', 'have')} no weight: left behind when others move.",
            "Weight them, or bind again.",
            vertices=empty,
            repair="give them the weights of the nearest vertex that has some",
        )
    off = np.flatnonzero((np.abs(sums - 1) > ROUNDING) & (sums > 0))
    if len(off):
        low, high = sums[off].min(), sums[off].max()
        yield Finding(
            "unnormalised-weights",
            "warning",
            f"In the file, the weights of {count(len(off), 'vertex', 'do')} not sum to one, but to "
            f"{low:.3g} to {high:.3g}: other programs may scale or shift the skin there.",
            "Normalise them.",
            vertices=off,
            repair="scale them to sum to one",
        )
    influences = (weights > 0).sum(axis=1)
    many = np.flatnonzero(influences > INFLUENCES)
    if len(many):
        yield Finding(
            "many-influences",
            "note",
            f"{count(len(many), 'vertex', 'follow')} up to {influences.max()} joints; game engines "
            f"read {INFLUENCES}.",
            f"Keep the {INFLUENCES} largest, if an engine is to read it.",
            vertices=many,
            repair=f"keep the {INFLUENCES} largest weights of each vertex",
        )


def _torn(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    place = subject.welded
    order = np.argsort(place, kind="stable")
    first = order[np.searchsorted(place[order], np.arange(len(subject.points)))]
    differs = np.abs(weights - weights[first[place]]).sum(axis=1) > DIFFERENT
    torn = np.zeros(len(subject.points), bool)
    torn[place[differs & subject.is_used]] = True
    if not torn.any():
        return
    places = len(np.unique(place[subject.is_used]))
    number = int(torn.sum())
    yield Finding(
        "torn-seams",
        "warning" if number > SEAMS * places else "note",
        f"At {count(number, 'place')} of {places:,} vertices lie together that follow different "
        "joints: the skin tears open there when it moves.",
        "Give vertices in one place the same weights.",
        vertices=subject.vertices_at(torn),
        repair="give vertices in one place the mean of their weights",
    )


def _leaked(
    subject: Subject, distances: BoneDistances, weights: NDArray[np.float64]
) -> Iterator[Finding]:
    vertex, joint = np.nonzero((weights > NOTICED) & measurable(subject, distances))
    is_reached = distances.fallback[vertex] == REACHED
    vertex, joint = vertex[is_reached], joint[is_reached]
    nearest = distances.least
    through = through_body(subject, distances, vertex, joint)
    straight = _straight(subject, distances, vertex, joint)
    beyond = through - nearest[vertex]
    with np.errstate(invalid="ignore"):
        leaked = (np.minimum(through - straight, beyond) > LEAP) | (beyond > FAR)
    leaked &= np.isfinite(beyond)
    if not leaked.any():
        return
    vertex, joint = vertex[leaked], joint[leaked]
    vertices, joints = np.unique(vertex), np.unique(joint)
    names = subject.rig.skeleton.names
    lines = []
    for j in joints[:MAX_LINES]:
        of_joint = vertex[joint == j]
        lines.append(
            f"{shown_name(names[j])}: up to {weights[of_joint, j].max():.0%} of "
            f"{count(len(of_joint), 'vertex')} far from it"
        )
    yield Finding(
        "leaked-weights",
        "warning",
        f"{count(len(vertices), 'vertex', 'follow')} joints that are far away through the body, "
        "past nearer ones.",
        "Remove this weight, from these vertices or the whole rig (cutcell clean), or bind again.",
        repair=CLEANED,
        vertices=vertices,
        joints=joints,
        details=tuple(lines),
    )


def measurable(subject: Subject, distances: BoneDistances) -> NDArray[np.bool_]:
    """Return which joints have distances through the body, shape (j,)."""
    has_distances = np.zeros(len(subject.joint_distance), bool)
    has_distances[distances.bones.joint] = True
    return has_distances & (subject.joint_distance <= OUTSIDE)


def through_body(
    subject: Subject, distances: BoneDistances, vertex: NDArray[np.intp], joint: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the distances through the body of vertices from joints, measured if necessary."""
    through = distances.at(joint, vertex)
    unknown = np.isinf(through)
    if unknown.any():
        which = np.isin(distances.bones.joint, joint[unknown])
        subset = replace(
            distances,
            bones=distances.bones.subset(which),
            sources=distances.sources.subset(which),
        )
        through = subset.all_joints(subject.progress)[joint, vertex]
    return through


def _straight(
    subject: Subject, distances: BoneDistances, vertex: NDArray[np.intp], joint: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the straight distances of vertices from the bones of joints."""
    bones, points = distances.bones, subject.points[subject.welded]
    least = np.full(len(vertex), np.inf)
    for j in np.unique(joint):
        of_joint = np.flatnonzero(joint == j)
        for b in np.flatnonzero(bones.joint == j):
            away = distance_to_segment(points[vertex[of_joint]], bones.start[b], bones.end[b])
            least[of_joint] = np.minimum(least[of_joint], away)
    return least
