"""Faults of the weights of a file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..geodesics.fallback import REACHED
from ..io.weights import STORED_SUM_TOLERANCE
from ..runtime.display import count
from .finding import Finding, finding_of
from .subject import Subject, bones_distance

INFLUENCES = 4
"""What game engines read."""
VISIBLE_WEIGHT = 0.05
"""A weight below it does not show."""
LEAP = 0.2
"""Part of the longest side: weight over paths this much longer through the body than straight
through the air, and than from the nearest joint, has leaked across a gap."""
FAR_BEYOND = 0.4
"""As far beyond the nearest joint it is out of place, whatever lies between."""
DIFFERENT = 0.02
"""Weights of vertices in one place may differ by this much in total."""
SEAMS = 0.05
"""Part of all places on the surface: if more tear, it is no accident of a few layers."""


def check_weights(subject: Subject) -> Iterator[Finding]:
    """Look for faults of the file's weights; a fresh character has none."""
    yield from _numbers(subject, subject.weights)
    yield from _torn(subject, subject.weights)
    yield from _leaked(subject, subject.weights)


def _numbers(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    sums = subject.rig.weight_sums
    sums = weights.sum(axis=1) if sums is None else sums
    yield from finding_of("invalid-weights", vertices=np.flatnonzero(np.isnan(sums)))
    empty = np.flatnonzero((weights.sum(axis=1) == 0) & subject.is_used)
    yield from finding_of("unweighted-vertices", vertices=empty)
    off = np.flatnonzero((np.abs(sums - 1) > STORED_SUM_TOLERANCE) & (sums > 0))
    low, high = sums[off].min(initial=np.inf), sums[off].max(initial=0)
    yield from finding_of("unnormalised-weights", vertices=off, low=low, high=high)
    influences = (weights > 0).sum(axis=1)
    many = np.flatnonzero(influences > INFLUENCES)
    yield from finding_of(
        "many-influences", vertices=many, most=influences.max(initial=0), limit=INFLUENCES
    )


def _torn(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    place = subject.welded
    first = subject.mesh.first[place]
    copies = np.flatnonzero((first != np.arange(len(first))) & subject.is_used)
    differs = np.abs(weights[copies] - weights[first[copies]]).sum(axis=1) > DIFFERENT
    torn = np.unique(place[copies[differs]])
    places = len(np.unique(place[subject.is_used]))
    severity = "warning" if len(torn) > SEAMS * places else "note"
    vertices = subject.vertices_at(torn)
    yield from finding_of(
        "torn-seams", severity=severity, vertices=vertices, torn=torn, places=places
    )


def _leaked(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    distances = subject.distances
    vertex, joint = np.nonzero((weights > VISIBLE_WEIGHT) & subject.measurable)
    is_reached = distances.fallback[vertex] == REACHED
    vertex, joint = vertex[is_reached], joint[is_reached]
    through = through_body(subject, vertex, joint)
    points, straight = subject.mesh.points[subject.welded[vertex]], np.empty(len(vertex))
    for j in np.unique(joint):
        straight[joint == j] = bones_distance(distances.bones, j, points[joint == j])
    beyond = through - distances.least[vertex]
    with np.errstate(invalid="ignore"):
        leaked = (np.minimum(through - straight, beyond) > LEAP) | (beyond > FAR_BEYOND)
    leaked &= np.isfinite(beyond)
    vertex, joint = vertex[leaked], joint[leaked]
    joints, number = np.unique(joint, return_counts=True)
    yield from finding_of(
        "leaked-weights",
        vertices=np.unique(vertex),
        joints=joints,
        details=[
            f"{subject.name(j)}: up to {weights[vertex[joint == j], j].max():.0%} of "
            f"{count(n, 'vertex')} far from it"
            for j, n in zip(joints, number.tolist(), strict=True)
        ],
        change=subject.weight_share(vertex, weights[vertex, joint]),
    )


def through_body(
    subject: Subject, vertex: NDArray[np.intp], joint: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the distances through the body of vertices from joints, measured if necessary."""
    distances = subject.distances
    through = distances.at(joint, vertex)
    unknown = np.isin(distances.bones.joint, joint[np.isinf(through)])
    if unknown.any():
        bones, sources = distances.bones.subset(unknown), distances.sources.subset(unknown)
        subset = replace(distances, bones=bones, sources=sources)
        through = subset.of_all_joints(subject.progress).at(joint, vertex)
    return through
