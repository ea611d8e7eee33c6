"""Points on surfaces, and characters in the unit cube."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.errors import MeshError
from cutcell.geometry.laplacian import vertex_normals
from cutcell.geometry.triangles import areas, unit_normals
from cutcell.rig import Rig


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points on the faces of a mesh, with barycentric coordinates `shares`."""

    places: NDArray[np.float64]  # (p, 3)
    face: NDArray[np.int64]  # (p,)
    shares: NDArray[np.float64]  # (p, 3)


def sample_surface(vertices: ArrayLike, faces: ArrayLike, count: int, seed: int) -> SurfacePoints:
    """Sample points on a mesh, with a density that is uniform by area.

    Shapes: vertices (n, 3), faces (m, 3).
    """
    places, corners = np.asarray(vertices, np.float64), np.asarray(faces)
    total = areas(places[corners]).cumsum()
    if not 0 < total[-1] < np.inf:
        raise MeshError("its faces have no area, so no points can be sampled on them")
    random = np.random.default_rng(seed)
    # One point in each of equal shares of the area: no clumps, and little noise.
    where = (np.arange(count) + random.random(count)) / count * total[-1]
    face = np.minimum(np.searchsorted(total, where, side="right"), len(corners) - 1)
    root, along = np.sqrt(random.random(count)), random.random(count)
    shares = np.stack([1 - root, root * (1 - along), root * along], axis=1)
    drawn = (places[corners[face]] * shares[:, :, None]).sum(axis=1)
    return SurfacePoints(drawn, face, shares)


def mesh_normals(
    vertices: ArrayLike, faces: ArrayLike
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return unit normals of the faces (m, 3) and of the vertices (n, 3); zero where undefined."""
    points, corners = np.ascontiguousarray(vertices, np.float64), np.array(faces, np.int32)
    by_vertex = vertex_normals(points, corners)
    return unit_normals(points[corners]).astype(np.float32), by_vertex.astype(np.float32)


@dataclass(frozen=True, eq=False)
class Normalised:
    """Joints and surface points of a character in the unit cube."""

    joints: NDArray[np.float32]  # (j, 3)
    points: NDArray[np.float32]  # (p, 3)


def normalised(rig: Rig, count: int, seed: int = 0) -> Normalised:
    """Scale a character into the unit cube and sample points on it."""
    low, high = rig.mesh.bounds
    size, middle = float((high - low).max()), (low + high) / 2
    vertices = (rig.mesh.vertices - middle) / size + 0.5
    joints = (rig.skeleton.joints - middle) / size + 0.5
    points = sample_surface(vertices, rig.mesh.faces, count, seed).places
    # Rounding may put a point a little outside of the cube.
    return Normalised(joints.astype(np.float32), points.clip(0, 1).astype(np.float32))
