"""Faults of the surface: faces, edges, rims and vertices."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geometry.triangles import face_edges, unit_normals
from ..geometry.weld import WELD_TOLERANCE, weld
from ..graph.surface import WALL
from .finding import Finding, finding_of
from .intersections import find_intersections
from .subject import Subject

UNWELDED = 0.9
"""Minimum ratio of vertices to corners of faces in a soup."""
HOLES = 8
"""Minimum number of missing triangles of a finding."""
DEGENERATE_AREA = 1e-10
"""Maximum area of a degenerate face, over its longest side squared."""
STRAY_DISTANCE = 2.0
"""Minimum distance of a stray vertex, in sizes of the rest of the mesh."""
MAX_STRAYS = 0.01
"""Maximum share of stray vertices."""
MAX_WIDTH = 1e-3
"""Maximum width of a crack, as part of the longest side."""
MAX_EDGE_PART = 0.25
"""Maximum width of a crack, as part of the median edge of rims."""
MIN_CRACK_EDGES = 6
"""Edges of rims that meet once the crack is closed."""
MANY_CRACKS = 0.25
"""Part of all edges of rims: fewer may be strips of hair or cloth that lie side by side."""


def check_mesh(subject: Subject) -> Iterator[Finding]:
    """Look for faults of the surface."""
    yield from _stray(subject)
    inverted = np.flatnonzero(subject.graph.inverted)
    yield from finding_of("inverted-faces", faces=inverted, part=subject.area_share(inverted))
    walls = np.flatnonzero(subject.graph.omitted == WALL)
    yield from finding_of("hollow-body", faces=walls, part=subject.area_share(walls))
    yield from _cracks(subject)
    yield from _open(subject)
    yield from _non_manifold(subject)
    yield from _doubled(subject)
    yield from _degenerate(subject)
    yield from find_intersections(subject)
    yield from _vertices(subject)


def _stray(subject: Subject) -> Iterator[Finding]:
    used = np.flatnonzero(subject.is_used)
    points = subject.rig.mesh.vertices[used]
    low, high = np.quantile(points, [MAX_STRAYS, 1 - MAX_STRAYS], axis=0)
    size = (high - low).max()
    away = np.maximum(low - points, points - high).max(axis=1)
    stray = used[away > STRAY_DISTANCE * size]
    if len(stray) <= MAX_STRAYS * len(used):
        farthest = away.max() / size if size else np.inf
        yield from finding_of("stray-vertices", vertices=stray, farthest=farthest)


def _cracks(subject: Subject) -> Iterator[Finding]:
    """Look for rims that fit together once they are drawn over a narrow gap."""
    loop, following = subject.mesh.boundary.loop, subject.mesh.boundary.following
    if len(loop) < MIN_CRACK_EDGES:
        return
    points = subject.mesh.points
    length = float(np.median(np.linalg.norm(points[loop] - points[following], axis=1)))
    wide = min(MAX_WIDTH, MAX_EDGE_PART * length)
    if wide <= WELD_TOLERANCE:
        return
    rim = np.unique(loop)
    _, group = weld(points[rim], wide)
    a, b = group[np.searchsorted(rim, loop)], group[np.searchsorted(rim, following)]
    # An edge of a rim is closed by one that runs the other way between the same places, if the
    # surface continues beyond it: the two rims of a double wall are no crack.
    key = np.minimum(a, b) * np.int64(len(rim)) + np.maximum(a, b)
    _, which = np.unique(key, return_inverse=True)
    normals = _rim_normals(subject, loop, following)
    together = np.stack([np.bincount(which, n) for n in normals.T], axis=1)[which]
    goes_on = np.einsum("ij,ij->i", together, normals) > 1
    is_closed = (np.bincount(which, np.sign(b - a))[which] == 0) & (a != b) & goes_on
    if is_closed.sum() < MIN_CRACK_EDGES:
        return
    at_crack = np.concatenate([loop[is_closed], following[is_closed]])
    yield from finding_of(
        "cracks",
        severity="warning" if is_closed.sum() >= MANY_CRACKS * len(loop) else "note",
        vertices=subject.vertices_at(at_crack),
        edges=is_closed.sum(),
        width=wide * subject.graph.lattice.size,
    )


def _rim_normals(
    subject: Subject, start: NDArray[np.int64], end: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the unit normals of the faces that sides of rims belong to."""
    faces, points = subject.faces, subject.mesh.points
    sides = faces.astype(np.int64) * len(points) + np.roll(faces, -1, axis=1)
    order = np.argsort(sides, axis=None, kind="stable")
    keys = start * len(points) + end
    side_faces = order[np.searchsorted(sides.ravel(), keys, sorter=order)] // 3
    return unit_normals(points[faces[side_faces]])


def _open(subject: Subject) -> Iterator[Finding]:
    loop, start = subject.mesh.boundary
    if not len(loop):
        return
    # The rim of faces that lie on copies is repeated.
    rims_once = {tuple(np.sort(rim)): rim for rim in np.split(loop, start[1:-1])}
    loop, lengths = np.concatenate([*rims_once.values()]), np.array([*map(len, rims_once)])
    start = np.cumsum(lengths) - lengths
    is_hole = np.zeros(len(lengths), bool)
    short = np.flatnonzero(lengths == 3)
    corners = np.sort(loop[start[short][:, None] + np.arange(3)], axis=1)
    near = subject.faces[np.isin(subject.faces, corners).all(axis=1)]
    lone = set(map(tuple, np.sort(near, axis=1).tolist()))  # a lone triangle has such a rim, too
    is_hole[short] = [tuple(triple) not in lone for triple in corners.tolist()]
    is_hole &= is_hole.sum() >= HOLES
    at_hole = np.repeat(is_hole, lengths)
    holes = subject.vertices_at(loop[at_hole])
    yield from finding_of("holes", vertices=holes, holes=is_hole.sum())
    rims = subject.vertices_at(loop[~at_hole])
    yield from finding_of("rims", vertices=rims, rims=(~is_hole).sum(), edges=(~at_hole).sum())


def _non_manifold(subject: Subject) -> Iterator[Finding]:
    edges, code = subject.mesh.edges, [len(subject.mesh.points), 1]  # one number for each edge
    tangled = edges.edges[edges.uses > 2]
    is_tangled = np.isin(face_edges(subject.faces) @ code, tangled @ code)
    faces = subject.whole[is_tangled.reshape(-1, 3).any(axis=1)]
    yield from finding_of("non-manifold-edges", faces=faces, edges=len(tangled))


def _doubled(subject: Subject) -> Iterator[Finding]:
    # The two sides of a face are no duplicates.
    faces = _rolled(subject.faces)
    copies = np.delete(subject.whole, np.unique(faces, axis=0, return_index=True)[1])
    yield from finding_of("duplicate-faces", faces=copies)


def _rolled(faces: NDArray[np.int32]) -> NDArray[np.int32]:
    """Begin each face at its lowest corner; its winding stays."""
    first = faces.argmin(axis=1)
    return np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)


def _degenerate(subject: Subject) -> Iterator[Finding]:
    mesh = subject.rig.mesh.welded
    corners = mesh.points[mesh.faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    flat = ~subject.mesh.is_whole | (mesh.face_areas <= DEGENERATE_AREA * longest**2)
    degenerate = np.flatnonzero(flat & (subject.graph.omitted == 0))
    if len(degenerate) < len(subject.areas):
        yield from finding_of("degenerate-faces", faces=degenerate)


def _vertices(subject: Subject) -> Iterator[Finding]:
    faces, used = subject.rig.mesh.faces, subject.rig.mesh.used
    if len(used) >= UNWELDED * faces.size and len(faces) > 1:
        left = len(np.unique(subject.welded[used]))
        yield from finding_of("unwelded-vertices", vertices=used, used=len(used), left=left)
    unused = np.setdiff1d(np.arange(len(subject.welded)), used)
    yield from finding_of("unused-vertices", vertices=unused)
