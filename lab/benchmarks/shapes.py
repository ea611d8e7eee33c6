"""Rigs of any size, to see how things grow."""

from __future__ import annotations

import numpy as np
import trimesh

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh


def make(case: dict) -> Rig:
    """Make the rig of a case: a file, as it is or with other bones, or a bumpy ball."""
    if "faces" in case:
        return bumpy_ball(case["faces"])
    rig = cutcell.load(case["rig"])
    if "bones" in case:
        return Rig(rig.mesh, chain(rig.mesh, case["bones"]))
    return rig


def small() -> Rig:
    """Make a rig that is bound at once."""
    return bumpy_ball(80, bones=2)


def bumpy_ball(faces: int, bones: int = 20) -> Rig:
    """Quarter an icosahedron's triangles up to a number of faces, and dent it."""
    times = round(np.log(faces / 20) / np.log(4))
    mesh = trimesh.creation.icosphere(subdivisions=times)
    points = np.array(mesh.vertices)
    bumps = np.sin(5 * points[:, 0]) * np.cos(4 * points[:, 1]) * np.cos(6 * points[:, 2])
    surface = TriangleMesh(points * (1 + 0.25 * bumps)[:, None], mesh.faces)
    return Rig(surface, chain(surface, bones))


def chain(mesh: TriangleMesh, bones: int) -> Skeleton:
    """Lay a chain of that many bones along the longest side of a mesh, winding a little."""
    low, high = mesh.bounds
    share = np.linspace(0.1, 0.9, bones + 1)
    joints = np.tile((low + high) / 2, (bones + 1, 1))
    axis = int(np.argmax(high - low))
    joints[:, axis] = low[axis] + share * (high - low)[axis]
    side = (axis + 1) % 3
    joints[:, side] += 0.05 * (high - low)[side] * np.sin(20 * share)
    deform = np.arange(bones + 1) < bones  # the last joint only ends the last bone
    return Skeleton(joints, np.arange(-1, bones), deform=deform)
