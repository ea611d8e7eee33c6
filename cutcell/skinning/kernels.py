"""All kernels of a binding at once, so that no character waits for one of them."""

import numpy as np

from ..geodesics import bone_distances
from ..graph import build_graph
from ..rig import Skeleton, TriangleMesh
from .weights import DEFAULT_LEAF, joints_needed, skinning_weights

AROUND = 16
"""Vertices around the tube: its open ends are holes too wide for a few triangles."""


def load_kernels() -> None:
    """Bind a small open tube in every way that has kernels of its own.

    Kernels are compiled once on a machine (about half a minute) and kept on disk; from there a
    process loads them in about a second.
    """
    skeleton = Skeleton(
        # The last joint is so far away that its labels outlast the queue's buckets.
        np.array([[0, 0, 0.1], [0, 0, 0.5], [0, 0, 0.8], [3, 3, 3]]),
        np.array([-1, 0, 1, -1]),
    )
    for connectivity in ("any", 26):
        graph = build_graph(_tube(), 8, connectivity=connectivity)
        distances = bone_distances(
            graph,
            skeleton,
            leaf=DEFAULT_LEAF["rig"],
            nearest_joints=joints_needed("rig", 4),
        )
        for falloff in ("rig", "paper"):
            skinning_weights(distances, falloff=falloff, max_influences=4)


def _tube() -> TriangleMesh:
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    heights = np.linspace(0, 1, 5)
    rings = [np.stack([np.cos(turn) / 5, np.sin(turn) / 5, np.full(AROUND, z)], 1) for z in heights]
    here = np.arange((len(heights) - 1) * AROUND)
    beside = here // AROUND * AROUND + (here + 1) % AROUND
    faces = [[here, beside, beside + AROUND], [here, beside + AROUND, here + AROUND]]
    return TriangleMesh(
        np.concatenate(rings), np.concatenate([np.stack(face, axis=1) for face in faces])
    )
