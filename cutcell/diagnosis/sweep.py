"""Faults of posed rigs: a sweep of poses, one joint at a time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.triangles import normals
from ..pose import axis_rotation
from ..pose.stretch import MAX_SHARE, STRETCH_DEGREES, followed, measure_stretch, turned_edges
from ..rig.rig import normalised
from ..runtime.display import share
from .finding import Finding, Pose, finding_of
from .subject import Subject

SWEEP_DEGREES = 45.0
"""Each joint turns by this about x, y and z, either way: less than elbows and knees do."""
TORN_EDGE = 4.0
"""An edge that becomes this much longer, by a chord of 45 degrees at most, joins vertices of which
one follows and the other stays far from the joint: no smooth bend does that."""
MIN_STRETCH = 0.03
"""Minimum lengthening of an edge that shows, as part of the longest side."""
FLIPPED = 0.01
"""Part of the surface: if as much is turned over in one pose, it is more than a crease."""
LOST_VOLUME = 0.1
"""Part of the volume of closed components that is lost in one pose."""
WARNING_FACTOR = 3.0
"""Times these bounds: then it is a warning. Artists' weights crease, too, where a joint bends in a
way that no animation asks of it."""
MOVES = 1e-3
"""A vertex that follows a joint less does not count as moved by it."""
WHOLE_WEIGHT = 1 - 1e-9
"""A vertex that follows a joint as much follows it wholly."""


def check_sweep(subject: Subject) -> Iterator[Finding]:
    """Turn one joint after the other and look for edges, faces and volumes that it ruins."""
    # By how much each welded vertex follows each joint, (j, k).
    follows = followed(normalised(subject.weights[subject.mesh.first]), subject.rig.skeleton)
    yield from _stretched_surface(subject)
    yield from _torn(subject, follows)
    poses = list(_poses(subject, follows))
    yield from _flipped(subject, [flip for flip, _ in poses if flip.size > FLIPPED])
    yield from _lost(subject, [loss for _, loss in poses if loss.size > LOST_VOLUME])


class _Fault(NamedTuple):
    """A fault in one pose: how large it is, and the elements at fault."""

    pose: Pose
    size: float
    elements: NDArray[np.intp] = np.zeros(0, np.intp)


def _turns() -> list[tuple[str, float, NDArray[np.float64]]]:
    return [
        (axis, way, axis_rotation(axis, way))
        for axis in "xyz"
        for way in (SWEEP_DEGREES, -SWEEP_DEGREES)
    ]


def _poses(subject: Subject, follows: NDArray[np.float64]) -> Iterator[tuple[_Fault, _Fault]]:
    """Yield the faces that flip, of those that are whole, and the volume that is lost, per pose."""
    points, faces = subject.mesh.points, subject.faces
    joints = subject.graph.lattice.to_unit(subject.rig.skeleton.joints)
    corners_of = np.ascontiguousarray(faces.T, np.intp)
    at_first = normals(points[faces])
    area = np.linalg.norm(at_first, axis=1).sum()
    is_open = np.zeros(subject.mesh.component.max() + 1, bool)
    is_open[subject.mesh.component[subject.mesh.boundary.loop]] = True
    # Faces of open components enclose nothing, inverted ones count as flipped.
    sign = np.where(is_open[subject.mesh.component[faces[:, 0]]], 0.0, 1.0)
    volume = np.einsum("i,ij,ij->", sign, points[faces[:, 0]], at_first)
    number = np.zeros(len(points), np.intp)
    turns = _turns()
    for j, joint in enumerate(joints):
        moved = follows[j]
        if not ((moved > MOVES) & (moved < 1 - MOVES)).any():
            continue  # all moves as one, or nothing does
        at_corners = moved[corners_of]
        low, high = at_corners.min(axis=0), at_corners.max(axis=0)
        # Vertices that follow wholly turn about the joint, which changes no volume around it.
        changing = np.flatnonzero((high > 0) & (low < WHOLE_WEIGHT))
        is_unlike = (high - low)[changing] > MOVES
        before, around = at_first[changing], faces[changing]
        follow = at_corners[:, changing].mean(axis=0)[:, None]
        # Only the vertices of these faces are posed.
        is_posed = np.zeros(len(points), bool)
        is_posed[around] = True
        posed_vertices = np.flatnonzero(is_posed)
        number[posed_vertices] = np.arange(len(posed_vertices))
        local_faces = number[around]
        arms, by = points[posed_vertices] - joint, moved[posed_vertices, None]
        enclosed = np.einsum("i,ij,ij->", sign[changing], arms[local_faces[:, 0]], before)
        for axis, degrees, turn in turns:
            posed = arms + by * (arms @ (turn - np.eye(3)).T)
            expected = before + follow * (before @ turn.T - before)
            after = normals(posed[local_faces])
            over = is_unlike & (np.einsum("ij,ij->i", after, expected) < 0)
            left = np.einsum("i,ij,ij->", sign[changing], posed[local_faces[:, 0]], after)
            pose, flipped = Pose(j, axis, degrees), np.linalg.norm(before[over], axis=1).sum()
            lost = (enclosed - left) / volume if volume > 0 else 0.0
            yield _Fault(pose, float(flipped / area), changing[over]), _Fault(pose, lost)


def _stretched_surface(subject: Subject) -> Iterator[Finding]:
    stretch = measure_stretch(subject.graph, subject.rig.skeleton, subject.weights)
    if stretch.share > MAX_SHARE and stretch.joint is not None:
        yield from finding_of(
            "stretched-surface",
            vertices=stretch.vertices,
            joints=np.array([stretch.joint]),
            details=[f"{subject.name(stretch.joint)}: the most, about {stretch.axis}"],
            pose=Pose(stretch.joint, stretch.axis, STRETCH_DEGREES),
            part=share(stretch.share, 1),
            degrees=STRETCH_DEGREES,
        )


def _torn(subject: Subject, follows: NDArray[np.float64]) -> Iterator[Finding]:
    torn = list(_torn_edges(subject, follows))
    vertices = subject.vertices_at(_joined(torn))
    evidence = _evidence(subject, torn, MIN_STRETCH, "by {} of the longest side")
    yield from finding_of("stretched-edges", vertices=vertices, times=TORN_EDGE, **evidence)


def _torn_edges(subject: Subject, follows: NDArray[np.float64]) -> Iterator[_Fault]:
    """Yield the welded ends of edges that become much longer, per pose."""
    edges, turns = subject.mesh.edges.edges, _turns()
    joints = subject.graph.lattice.to_unit(subject.rig.skeleton.joints)
    rotations = [turn for _, _, turn in turns]
    turned = np.arange(len(joints))
    points = subject.mesh.points
    for block in turned_edges(points, edges, follows, joints, turned, rotations, TORN_EDGE):
        longer = block.after - block.before
        is_torn = (longer > MIN_STRETCH) & (longer > (TORN_EDGE - 1) * block.before)
        for t, (axis, degrees, _) in enumerate(turns):
            for joint in np.unique(block.joint[is_torn[:, t]]):
                rows = is_torn[:, t] & (block.joint == joint)
                vertices = np.unique(edges[block.edge[rows]]).astype(np.intp)
                longest = float(longer[rows, t].max())
                yield _Fault(Pose(int(joint), axis, degrees), longest, vertices)


def _flipped(subject: Subject, faults: list[_Fault]) -> Iterator[Finding]:
    faces = subject.whole[_joined(faults)]
    vertices = np.unique(subject.rig.mesh.faces[faces]).astype(np.intp)
    evidence = _evidence(subject, faults, FLIPPED, "{} of the surface")
    yield from finding_of("flipped-faces", vertices=vertices, faces=faces, **evidence)


def _lost(subject: Subject, faults: list[_Fault]) -> Iterator[Finding]:
    evidence = _evidence(subject, faults, LOST_VOLUME, "{} of the volume")
    follows = (subject.weights[:, evidence["joints"]] > MOVES).any(axis=1)
    yield from finding_of("lost-volume", vertices=np.flatnonzero(follows), **evidence)


def _joined(faults: Iterable[_Fault]) -> NDArray[np.intp]:
    return np.unique(np.concatenate([np.zeros(0, np.intp), *(one.elements for one in faults)]))


def _evidence(
    subject: Subject, faults: Iterable[_Fault], bound: float, text: str
) -> dict[str, Any]:
    """Return severity, joints, worst pose, and a line for each joint of its worst pose."""
    faults, best = sorted(faults, key=lambda fault: -fault.size), dict[int, str]()
    for pose, size, _ in faults:
        line = f"{subject.name(pose.joint)}: {text.format(share(size, 1))}, about {pose.axis}"
        best.setdefault(pose.joint, line)
    most = faults[0].size if faults else 0.0
    return {
        "severity": "warning" if most > WARNING_FACTOR * bound else "note",
        "joints": np.array(sorted(best), np.intp),
        "details": list(best.values()),
        "pose": faults[0].pose if faults else None,
        "most": share(most, 1),
        "degrees": SWEEP_DEGREES,
    }
