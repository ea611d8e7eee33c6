"""A cage around voxels: a coarse closed surface at some distance."""

from __future__ import annotations

import igl
import numpy as np
from scipy.ndimage import distance_transform_edt

OFFSET = 1.5
"""Voxels between the solid ones and the cage."""
PAD = 4
"""Empty voxels around all."""


def make_cage(solid, points, faces):
    """Wrap solid voxels in a surface of few triangles that still holds all points.

    Shapes: solid (a, b, c), points (k, 3).
    """
    away = distance_transform_edt(~np.pad(solid, PAD))
    # libigl counts x fastest.
    centres = np.indices(away.shape[::-1]).reshape(3, -1)[::-1].T + 0.5 - PAD
    field = away.transpose(2, 1, 0).ravel()
    shape = away.shape
    vertices, triangles = igl.marching_cubes(field, centres, *shape, OFFSET)[:2]
    corners = vertices[triangles]
    if np.linalg.det(corners).sum() < 0:
        triangles = triangles[:, ::-1]
    count = int(faces)
    while count < len(triangles):
        less, fewer = igl.decimate(
            np.asfortranarray(vertices), np.asfortranarray(triangles.astype(np.int32)), count
        )[:2]
        if holds(less, fewer, points):
            return {"vertices": less, "faces": fewer}
        count *= 2
    if not holds(vertices, triangles, points):
        raise RuntimeError("no cage could be found that holds the whole mesh")
    return {"vertices": vertices, "faces": triangles}


def holds(vertices, faces, points):
    """Whether all points are inside."""
    vertices = np.ascontiguousarray(vertices, np.float64)
    faces = np.ascontiguousarray(faces, np.int64)
    return (igl.winding_number(vertices, faces, np.ascontiguousarray(points)) > 0.5).all()
