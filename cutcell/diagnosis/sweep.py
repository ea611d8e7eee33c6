"""Faults of posed rigs: a sweep of poses, one joint at a time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geometry.triangles import normals
from ..pose import axis_rotation
from .finding import Finding, Pose, found, share
from .subject import Subject

DEGREES = 45.0
"""Each joint turns by this about x, y and z, either way: less than elbows and knees do."""
STRETCH = 4.0
"""An edge that becomes this much longer, by a chord of 45 degrees at most, joins vertices of which
one follows and the other stays far from the joint: no smooth bend does that."""
MIN_STRETCH = 0.03
"""Minimum lengthening of an edge that shows, as part of the longest side."""
FLIPPED = 0.01
"""Part of the surface: if as much is turned over in one pose, it is more than a crease."""
LOST = 0.1
"""Part of the volume of closed components that is lost in one pose."""
WARNING_FACTOR = 3.0
"""Times these bounds: then it is a warning. Artists' weights crease, too, where a joint bends in a
way that no animation asks of it."""
MOVES = 1e-3
"""A vertex that follows a joint less does not count as moved by it."""
ALL = 1 - 1e-9
"""A vertex that follows a joint as much follows it wholly."""


def check_sweep(subject: Subject) -> Iterator[Finding]:
    """Turn one joint after the other and look for edges, faces and volumes that it ruins."""
    faults = sorted(_poses(subject), key=lambda fault: -fault.longest)
    yield from _stretched(subject, faults)
    yield from _flipped(subject, faults)
    yield from _lost(subject, faults)


@dataclass(frozen=True, eq=False)
class _PoseFaults:
    """Faults in one pose."""

    pose: Pose
    stretched: NDArray[np.intp]  # welded vertices
    longest: float
    flipped: NDArray[np.intp]  # of the faces that are whole
    flipped_area: float
    lost: float


def _poses(subject: Subject) -> Iterator[_PoseFaults]:
    skeleton, points, faces = subject.rig.skeleton, subject.points, subject.faces
    shares = subject.weights[subject.first]
    total = shares.sum(axis=1, keepdims=True)
    shares /= np.where(total > 0, total, 1)
    followed = skeleton.subtree @ shares.T  # (j, k)
    del shares  # 50 joints of a million vertices take half a gigabyte
    joints = subject.graph.lattice.to_unit(skeleton.joints)
    edges = subject.edges.edges
    ends_of, corners_of = (np.ascontiguousarray(rows.T, np.intp) for rows in (edges, faces))
    length = _lengths(points[edges])
    at_first = normals(points[faces])
    area = np.linalg.norm(at_first, axis=1).sum()
    is_open = np.zeros(subject.component.max() + 1, bool)
    is_open[subject.component[subject.boundary.loop]] = True
    # Faces of open components enclose nothing, inverted ones count as flipped.
    sign = np.where(subject.graph.inverted[subject.whole], -1.0, 1.0)
    sign[is_open[subject.component[faces[:, 0]]]] = 0.0
    volume = np.einsum("i,ij,ij->", sign, points[faces[:, 0]], at_first)
    number = np.zeros(len(points), np.intp)
    turns = [(axis, way, axis_rotation(axis, way)) for axis in "xyz" for way in (DEGREES, -DEGREES)]
    for j, joint in enumerate(joints):
        moved = followed[j]
        if not ((moved > MOVES) & (moved < 1 - MOVES)).any():
            continue  # all moves as one, or nothing does
        bent = np.flatnonzero(np.ptp(moved[ends_of], axis=0) > MOVES)
        at_corners = moved[corners_of]
        low, high = at_corners.min(axis=0), at_corners.max(axis=0)
        # Vertices that follow wholly turn about the joint, which changes no volume around it.
        changing = np.flatnonzero((high > 0) & (low < ALL))
        is_unlike = (high - low)[changing] > MOVES
        before, around, ends = at_first[changing], faces[changing], edges[bent]
        follow = at_corners[:, changing].mean(axis=0)[:, None]
        # Only the vertices of these faces are posed; bent edges are theirs.
        is_posed = np.zeros(len(points), bool)
        is_posed[around] = True
        posed_vertices = np.flatnonzero(is_posed)
        number[posed_vertices] = np.arange(len(posed_vertices))
        local_ends, local_faces = number[ends], number[around]
        arms, by = points[posed_vertices] - joint, moved[posed_vertices, None]
        enclosed = np.einsum("i,ij,ij->", sign[changing], arms[local_faces[:, 0]], before)
        for axis, degrees, turn in turns:
            posed = arms + by * (arms @ (turn - np.eye(3)).T)
            longer = _lengths(posed[local_ends]) - length[bent]
            torn = (longer > MIN_STRETCH) & (longer > (STRETCH - 1) * length[bent])
            expected = before + follow * (before @ turn.T - before)
            after = normals(posed[local_faces])
            over = is_unlike & (np.einsum("ij,ij->i", after, expected) < 0)
            left = np.einsum("i,ij,ij->", sign[changing], posed[local_faces[:, 0]], after)
            yield _PoseFaults(
                Pose(j, axis, degrees),
                np.unique(ends[torn]),
                float(longer[torn].max(initial=0)),
                changing[over],
                float(np.linalg.norm(before[over], axis=1).sum() / area),
                (enclosed - left) / volume if volume > 0 else 0.0,
            )


def _lengths(ends: NDArray[np.float64]) -> NDArray[np.float64]:
    along = ends[:, 0] - ends[:, 1]
    return np.sqrt(np.einsum("ij,ij->i", along, along))


def _stretched(subject: Subject, faults: list[_PoseFaults]) -> Iterator[Finding]:
    torn = _worst(faults, "longest", 0)
    yield from found(
        "stretched-edges",
        vertices=subject.vertices_at(_joined(fault.stretched for fault in torn)),
        times=STRETCH,
        **_evidence(subject, torn, "longest", MIN_STRETCH, "by {} of the longest side"),
    )


def _flipped(subject: Subject, faults: list[_PoseFaults]) -> Iterator[Finding]:
    over = _worst(faults, "flipped_area", FLIPPED)
    faces = subject.whole[_joined(fault.flipped for fault in over)]
    yield from found(
        "flipped-faces",
        vertices=np.unique(subject.rig.mesh.faces[faces]).astype(np.intp),
        faces=faces,
        **_evidence(subject, over, "flipped_area", FLIPPED, "{} of the surface"),
    )


def _lost(subject: Subject, faults: list[_PoseFaults]) -> Iterator[Finding]:
    evidence = _evidence(subject, _worst(faults, "lost", LOST), "lost", LOST, "{} of the volume")
    follows = (subject.weights[:, evidence["joints"]] > MOVES).any(axis=1)
    yield from found("lost-volume", vertices=np.flatnonzero(follows), **evidence)


def _worst(faults: list[_PoseFaults], size: str, bound: float) -> list[_PoseFaults]:
    """Return the faults above a bound, the largest first."""
    over = [fault for fault in faults if getattr(fault, size) > bound]
    return sorted(over, key=lambda fault: -getattr(fault, size))


def _joined(numbers: Iterable[NDArray[np.intp]]) -> NDArray[np.intp]:
    return np.unique(np.concatenate([np.zeros(0, np.intp), *numbers]))


def _evidence(
    subject: Subject, faults: list[_PoseFaults], size: str, bound: float, text: str
) -> dict[str, Any]:
    """Return severity, joints, worst pose, and a line for each joint of its worst pose."""
    best: dict[int, str] = {}
    for fault in faults:
        part = text.format(share(getattr(fault, size), 1))
        line = f"{subject.name(fault.pose.joint)}: {part}, about {fault.pose.axis}"
        best.setdefault(fault.pose.joint, line)
    most = getattr(faults[0], size) if faults else 0.0
    return {
        "severity": "warning" if most > WARNING_FACTOR * bound else "note",
        "joints": np.array(sorted(best), np.intp),
        "details": list(best.values()),
        "pose": faults[0].pose if faults else None,
        "most": share(most, 1),
        "degrees": DEGREES,
    }
