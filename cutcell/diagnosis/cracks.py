"""Cracks: rims that run side by side, too far apart to be welded and too near to be meant."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geometry.triangles import unit_normals
from ..geometry.weld import WELD_TOLERANCE, weld
from .finding import Finding, count
from .subject import Subject

WIDE = 1e-3
"""Maximum width of a crack, as part of the longest side."""
OF_AN_EDGE = 0.25
"""Maximum width of a crack, as part of the median edge of rims."""
FEWEST = 6
"""Edges of rims that meet once the crack is closed."""
MANY = 0.25
"""Part of all edges of rims: fewer may be strips of hair or cloth that lie side by side."""


def find_cracks(subject: Subject) -> Iterator[Finding]:
    """Look for rims that fit together once they are drawn over a narrow gap."""
    loop, following = subject.boundary.loop, subject.boundary.following
    if len(loop) < FEWEST:
        return
    points = subject.points
    length = float(np.median(np.linalg.norm(points[loop] - points[following], axis=1)))
    wide = min(WIDE, OF_AN_EDGE * length)
    if wide <= WELD_TOLERANCE:
        return
    rim = np.unique(loop)
    _, group = weld(points[rim], wide)
    a, b = group[np.searchsorted(rim, loop)], group[np.searchsorted(rim, following)]
    # An edge of a rim is closed by one that runs the other way between the same places, if the
    # surface continues beyond it: the two rims of a double wall are no crack.
    key = np.minimum(a, b) * np.int64(len(rim)) + np.maximum(a, b)
    _, which = np.unique(key, return_inverse=True)
    normals = _normals(subject, loop, following)
    together = np.stack([np.bincount(which, n) for n in normals.T], axis=1)[which]
    goes_on = np.einsum("ij,ij->i", together, normals) > 1
    is_closed = (np.bincount(which, np.sign(b - a))[which] == 0) & (a != b) & goes_on
    if is_closed.sum() < FEWEST:
        return
    size = subject.graph.lattice.size
    at_crack = np.zeros(len(points), bool)
    at_crack[loop[is_closed]] = at_crack[following[is_closed]] = True
    yield Finding(
        "cracks",
        "warning" if is_closed.sum() >= MANY * len(loop) else "note",
        f"{count(int(is_closed.sum()), 'edge', 'lie')} along open rims less than {wide * size:.2g} "
        "from others that fit: seams that were not welded.",
        f"Merge vertices by a distance of {wide * size:.2g}.",
        vertices=subject.vertices_at(at_crack),
    )


def _normals(
    subject: Subject, start: NDArray[np.int64], end: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the unit normals of the faces that sides of rims belong to."""
    faces, points = subject.graph.faces[subject.whole], subject.points
    sides = faces.astype(np.int64) * len(points) + np.roll(faces, -1, axis=1)
    order = np.argsort(sides, axis=None, kind="stable")
    keys = start * len(points) + end
    side_faces = order[np.searchsorted(sides.ravel(), keys, sorter=order)] // 3
    return unit_normals(points[faces[side_faces]])
