"""Suspicious weights, without a reference."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..editing.selections import Neighbours
from ..geodesics.fallback import REACHED
from ..geometry.triangles import label_components
from ..rig.rows import least
from ..runtime.display import count, share
from .finding import Finding, Pose, finding_of
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
STANDS_OUT, STANDS_OUT_ALONE = 0.05, 0.1
"""Part of a vertex's weight beyond the range of all its neighbours, and by this much more so than
at its mirror image: noise. The other value holds where there is no other side to compare with."""
UNLIKE_OTHER, UNLIKE_AROUND = 0.05, 0.02
"""Part of the weight that differs from the other side, or lies beyond the range, in such a region.
"""
MUCH_NOISE = 0.001
"""Part of all weight: more noise than this is most likely a fault."""
POSE_DEGREES = 45.0
"""How far a joint turns in the pose that shows a finding."""


def check_leaks(subject: Subject) -> Iterator[Finding]:
    """Look for weight that is suspicious whatever else the file says."""
    yield from _stray(subject, subject.weights)
    yield from _islands(subject, subject.weights)
    apart = _from_the_other_side(subject, subject.weights)
    yield from _noisy(subject, subject.weights, apart)
    yield from _asymmetric(subject, subject.weights, apart)


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
    yield from finding_of(
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
        change=float(shares[stray].sum()),
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
    joints, places, lines, worst, change = [], [], [], (0.0, -1), 0.0
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
        change += float(at_welded[j, islands] @ area[islands]) / area.sum()
        worst = max(worst, (most, j))
        where = f"{count(len(np.unique(label)), 'island')} of {count(len(islands), 'vertex')}"
        lines.append(f"{subject.name(j)}: up to {most:.0%} on {where}")
    if not joints:
        return
    vertices = subject.vertices_at(np.concatenate(places))
    pose, at = pose_of(subject, worst[1], vertices), np.array(joints)
    yield from finding_of(
        "weight-islands", vertices=vertices, joints=at, details=lines, pose=pose, change=change
    )


def _from_the_other_side(
    subject: Subject, weights: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Return the part of each vertex's weight that its mirror image gives to other joints, (n,).

    It is nan where there is none to compare with, and None for a mesh that is not mirrored.
    """
    mirror = subject.mirror
    if mirror is None:
        return None
    # On the plane itself a vertex is its own partner; joints without a partner are no evidence.
    alone = (weights[:, mirror.joint < 0] > 0).any(axis=1)
    paired = np.flatnonzero((mirror.vertex >= 0) & ~alone & subject.is_used)
    apart = np.full(len(weights), np.nan)
    other = weights[mirror.vertex[paired]][:, mirror.swap]
    apart[paired] = np.abs(weights[paired] - other).sum(axis=1) / 2
    return apart


def _noisy(
    subject: Subject, weights: NDArray[np.float64], apart: NDArray[np.float64] | None
) -> Iterator[Finding]:
    """Look for rows that differ from those of their neighbours, and from the other side's."""
    mesh = subject.mesh
    neighbours = Neighbours.along(mesh)
    beyond = _beyond_neighbours(weights[mesh.first], neighbours.links)
    if apart is None or subject.mirror is None:
        is_noise, adjoins = beyond > STANDS_OUT_ALONE, beyond > UNLIKE_AROUND
        # A pass goes half of the way to the neighbours.
        change = np.abs(weights - neighbours.smooth(weights, 1))[mesh.first].sum(axis=1)
    else:
        change = np.nan_to_num(apart)[mesh.first]
        adjoins = change > UNLIKE_OTHER
        beyond -= beyond[neighbours.welded[subject.mirror.vertex[mesh.first]]]
        is_noise = adjoins & (beyond > STANDS_OUT)
    edges = mesh.edges.edges
    label = label_components(edges[adjoins[edges].all(axis=1)], len(change))
    # Of a region and its mirror image, one is the noise.
    labels = np.intersect1d(label[is_noise], np.flatnonzero(np.bincount(label, beyond) > 0))
    if not len(labels):
        return
    amount = change * mesh.areas / mesh.areas.sum()
    regions = [np.flatnonzero(label == one) for one in labels]
    places, joints, lines = np.concatenate(regions), [], []
    for region in sorted(regions, key=lambda one: -float(amount[one].sum())):
        joint = int((mesh.areas[region] @ weights[mesh.first[region]]).argmax())
        joints.append(joint)
        number = count(len(subject.vertices_at(region)), "vertex")
        part = f"L1 {2 * change[region].mean():.2f}, {share(amount[region].sum(), 1)} of all weight"
        lines.append(f"{subject.name(joint)}: {number}, {part}")
    total, vertices = float(amount[places].sum()), subject.vertices_at(places)
    yield from finding_of(
        "noisy-weights",
        severity="warning" if total > MUCH_NOISE else "note",
        vertices=vertices,
        joints=np.unique(joints),
        details=lines,
        pose=pose_of(subject, joints[0], vertices),
        whom="from the skin around" + ("" if apart is None else " and from the other side"),
        change=total,
    )


def _beyond_neighbours(rows: NDArray[np.float64], links: csr_array) -> NDArray[np.float64]:
    """Return the part of weights that is more, or less, than that of all neighbours, shape (k,).

    Shapes: rows (k, j), links (k, k). Weights that fall steadily, in steps too, have none.
    """
    beyond, has_any = np.zeros(len(rows)), np.diff(links.indptr) > 0
    for column in np.ascontiguousarray(rows.T):
        weighted = np.flatnonzero(column)
        near = np.union1d(weighted, links[weighted].indices)  # elsewhere all are zero
        near = near[has_any[near]]
        if len(near):
            part, own = links[near], column[near]
            around, begin = column[part.indices], part.indptr[:-1]
            more = own - np.maximum.reduceat(around, begin)
            less = np.minimum.reduceat(around, begin) - own
            beyond[near] += np.maximum(np.maximum(more, less), 0) / 2
    return np.asarray(beyond * rows.any(axis=1))  # no weight at all is another fault


def _asymmetric(
    subject: Subject, weights: NDArray[np.float64], apart: NDArray[np.float64] | None
) -> Iterator[Finding]:
    if apart is None or subject.mirror is None:
        return
    asymmetric = np.flatnonzero(apart > UNLIKE)
    if len(asymmetric) <= ASYMMETRIC * np.isfinite(apart).sum():
        return
    other = weights[subject.mirror.vertex[asymmetric]][:, subject.mirror.swap]
    gap = np.abs(weights[asymmetric] - other)
    joints = np.flatnonzero((gap > UNLIKE).any(axis=0))
    pose = pose_of(subject, int(gap.sum(axis=0).argmax()), asymmetric)
    change = subject.weight_share(asymmetric, apart[asymmetric])
    yield from finding_of(
        "asymmetric-weights", vertices=asymmetric, joints=joints, pose=pose, change=change
    )


def pose_of(subject: Subject, joint: int, vertices: NDArray[np.intp]) -> Pose:
    """Turn a joint about the axis that moves some vertices most."""
    away = subject.rig.mesh.vertices[vertices] - subject.rig.skeleton.joints[joint]
    spread = (away**2).sum(axis=0)
    return Pose(joint, "xyz"[int(np.argmin(spread))], POSE_DEGREES)
