"""Small inputs that take every path through a binding, so that all of it is compiled."""

from __future__ import annotations

import numpy as np

from ..rig import Skeleton, TriangleMesh

AROUND = 16
"""Vertices around the tube: its open ends are holes too wide for a few triangles."""
MISSING = 5, 25, 45, 65, 85
"""Faces of the tube that leave small holes: enough holes for a tree of them."""
TETRAHEDRON = np.array([[0.3, 0, 0.5], [0.35, 0, 0.5], [0.3, 0.05, 0.5], [0.3, 0, 0.55]])
"""Beside the tube: there is work for several components only. It is inside out."""
MOEBIUS_BAND = np.array(
    [[0.3, 0, 0.1], [0.3, 0, 0.2], [0.4, 0, 0.15], [0.4, 0.1, 0.1], [0.3, 0.1, 0.15]]
)
"""Five faces that cannot be oriented consistently."""


def tube() -> TriangleMesh:
    """Return a tube with holes, and beside it a tetrahedron and a Moebius band."""
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    heights = np.linspace(0, 1, 5)
    rings = [np.stack([np.cos(turn) / 5, np.sin(turn) / 5, np.full(AROUND, z)], 1) for z in heights]
    vertex = np.arange((len(heights) - 1) * AROUND)
    after = vertex // AROUND * AROUND + (vertex + 1) % AROUND
    faces = [[vertex, after, after + AROUND], [vertex, after + AROUND, vertex + AROUND]]
    whole = np.concatenate([np.stack(face, axis=1) for face in faces])
    cut = np.delete(whole, MISSING, axis=0)
    count = len(rings) * AROUND
    tetrahedron = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]) + count
    band = (np.arange(5)[:, None] + np.arange(3)) % 5 + count + len(TETRAHEDRON)
    vertices = np.concatenate([*rings, TETRAHEDRON, MOEBIUS_BAND])
    return TriangleMesh(vertices, np.concatenate([cut, tetrahedron, band]))


def chain() -> Skeleton:
    """Return more joints than a vertex has distances of.

    The last is so far away that its labels outlast the queue's buckets.
    """
    joints = np.zeros((8, 3))
    joints[:, 2] = np.linspace(0.1, 0.9, 8)
    joints[-1] = 3
    return Skeleton(joints, np.array([*range(-1, 6), -1]))
