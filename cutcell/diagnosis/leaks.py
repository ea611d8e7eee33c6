"""Suspicious weights, without a reference."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geodesics.fallback import REACHED
from ..geometry.triangles import label_components
from ..rig.rows import least
from ..runtime.display import count, share
from .finding import Finding, Pose, found
from .subject import Subject
from .weights import VISIBLE_WEIGHT, through_body

STRAY_WEIGHT = 0.002
"""Part of all weight: a joint with less in the file was hardly meant to move skin."""
OWNED = 0.01
"""Part of the surface that is nearest to such a joint: a binding would give it about as much."""
LEADING = 0.5
"""A joint with more weight than this somewhere has a part to move, however small."""
AWAY = 0.1
"""Part of the longest side: where a joint is this much farther than the nearest one, an island
of its influence is no part of the limb that it moves."""
UNLIKE = 0.25
"""Part of a vertex's weight on other joints than those of its mirror image."""
ASYMMETRIC = 0.01
"""Part of the vertices that may differ as much: artists mend single ones."""
POSE_DEGREES = 45.0
"""How far a joint turns in the pose that shows a finding."""


def check_leaks(subject: Subject) -> Iterator[Finding]:
    """Look for weight that is suspicious whatever else the file says."""
    yield from _stray(subject, subject.weights)
    yield from _islands(subject, subject.weights)
    yield from _asymmetric(subject, subject.weights)


def _stray(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    area = subject.vertex_areas
    shares = area @ weights / area.sum()
    nearest = subject.distances.nearest_joint
    reached = subject.distances.fallback == REACHED
    owned = np.bincount(nearest[reached], area[reached], len(shares)) / area.sum()
    stray = np.flatnonzero((shares > 0) & (shares < STRAY_WEIGHT) & (owned > OWNED))
    if not len(stray):
        return
    stray = stray[np.argsort(-owned[stray], kind="stable")]
    yield from found(
        "stray-weights",
        vertices=np.flatnonzero((weights[:, stray] > 0).any(axis=1)),
        joints=np.sort(stray),
        details=[
            f"{subject.name(j)}: {100 * shares[j]:.2g}% of the weight, nearest to "
            f"{share(owned[j], 1)} of the surface"
            for j in stray
        ],
        pose=pose_of(subject, int(stray[0]), np.flatnonzero(nearest == stray[0])),
        advice=_stray_advice(weights[:, stray]),
    )


def moves_own_part(weights: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which joints lead some vertex, as eyes and jaws do and controls do not; shape (j,).

    Shapes: weights (n, j).
    """
    return np.asarray(weights.max(axis=0, initial=0) > LEADING)


def _stray_advice(weights: NDArray[np.float64]) -> str:
    moves, advice = moves_own_part(weights), []
    if moves.any():
        advice.append("Lock joints that lead a part, such as eyes, to their weights in the file.")
    if not moves.all():
        advice.append("Let controls carry no weight.")
    return " ".join(advice)


def _islands(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    distances = subject.distances
    edges = np.ascontiguousarray(subject.mesh.edges.edges.T, np.intp)
    at_welded, area = np.ascontiguousarray(weights[subject.mesh.first].T), subject.mesh.areas
    joints, places, lines, worst = [], [], [], (0.0, -1)
    has_bone = np.isin(np.arange(weights.shape[1]), distances.bones.joint)
    to_joint, number = least(distances.rows), np.zeros(len(area), np.intp)
    for j in np.flatnonzero(has_bone & (at_welded.max(axis=1) > VISIBLE_WEIGHT)).tolist():
        follows = at_welded[j] > VISIBLE_WEIGHT
        influenced = np.flatnonzero(follows)
        number[influenced] = np.arange(len(influenced))
        between = number[edges[:, follows[edges].all(axis=0)]]
        label = label_components(between.T, len(influenced))
        total = np.bincount(label, (at_welded[j] * area)[influenced])
        # An island is away from a larger region of the same joint on the same component.
        of = subject.mesh.component[influenced]
        largest = np.zeros(of.max() + 1)
        np.maximum.at(largest, of, total[label])
        is_island = total[label] < largest[of]
        islands, label = influenced[is_island], label[is_island]
        if not len(islands):
            continue
        through = through_body(subject, subject.mesh.first[islands], np.full(len(islands), j))
        beyond = through - to_joint[islands]
        nearest = np.full(len(total), np.inf)
        np.minimum.at(nearest, label, np.where(np.isfinite(beyond), beyond, -np.inf))
        is_away = nearest[label] > AWAY
        islands, label = islands[is_away], label[is_away]
        if not len(islands):
            continue
        most = float(at_welded[j, islands].max())
        joints.append(j)
        places.append(islands)
        worst = max(worst, (most, j))
        where = f"{count(len(np.unique(label)), 'island')} of {count(len(islands), 'vertex')}"
        lines.append(f"{subject.name(j)}: up to {most:.0%} on {where}")
    if not joints:
        return
    vertices = subject.vertices_at(np.concatenate(places))
    pose, at = pose_of(subject, worst[1], vertices), np.array(joints)
    yield from found("weight-islands", vertices=vertices, joints=at, details=lines, pose=pose)


def _asymmetric(subject: Subject, weights: NDArray[np.float64]) -> Iterator[Finding]:
    mirror = subject.mirror
    if mirror is None:
        return
    partner, swap = mirror.vertex, mirror.joint
    # On the plane itself a vertex is its own partner; joints without a partner are no evidence.
    alone = (weights[:, swap < 0] > 0).any(axis=1)
    paired = np.flatnonzero((partner >= 0) & ~alone & subject.is_used)
    if not len(paired):
        return
    other = weights[partner[paired]][:, np.where(swap < 0, np.arange(len(swap)), swap)]
    differ = np.abs(weights[paired] - other).sum(axis=1) / 2
    asymmetric = paired[differ > UNLIKE]
    if len(asymmetric) <= ASYMMETRIC * len(paired):
        return
    gap = np.abs(weights[paired] - other)[differ > UNLIKE]
    joints = np.flatnonzero((gap > UNLIKE).any(axis=0))
    pose = pose_of(subject, int(gap.sum(axis=0).argmax()), asymmetric)
    yield from found("asymmetric-weights", vertices=asymmetric, joints=joints, pose=pose)


def pose_of(subject: Subject, joint: int, vertices: NDArray[np.intp]) -> Pose:
    """Turn a joint about the axis that moves some vertices most."""
    away = subject.rig.mesh.vertices[vertices] - subject.rig.skeleton.joints[joint]
    spread = (away**2).sum(axis=0)
    return Pose(joint, "xyz"[int(np.argmin(spread))], POSE_DEGREES)
