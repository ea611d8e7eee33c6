"""A small sound character for tests: a worm of seven joints."""

import numpy as np
import trimesh

from cutcell import Rig, Skeleton, TriangleMesh

ALONG = np.linspace(0.1, 0.9, 7)
SWEEP = {"stretched-surface", "stretched-edges", "flipped-faces", "lost-volume"}
"""Findings of a sweep of poses, which any change of weights may bring or take away."""
NAMES = ("root", "tail", "hip", "spine", "chest", "neck", "head")


def worm() -> Rig:
    """Return a closed capsule along x, one unit long, with weights that blend along it."""
    capsule = trimesh.creation.capsule(height=0.76, radius=0.12, count=[8, 10])
    vertices = np.array(capsule.vertices)[:, [2, 0, 1]]
    vertices[:, 0] += 0.5 - vertices[:, 0].mean()
    # A capsule has vertices at its ends alone; weights need some along it to blend over.
    mesh = trimesh.Trimesh(vertices, capsule.faces).subdivide_to_size(0.13)
    apart = np.abs(np.array(mesh.vertices)[:, :1] - ALONG) / (ALONG[1] - ALONG[0])
    weights = np.maximum(1 - apart, 1e-9 * (apart < 1.5))
    weights /= weights.sum(axis=1, keepdims=True)
    joints = np.stack([ALONG, 0 * ALONG, 0 * ALONG], axis=1)
    skeleton = Skeleton(joints, np.arange(-1, 6), NAMES)
    return Rig(TriangleMesh(mesh.vertices, mesh.faces), skeleton, weights=weights, name="worm")
