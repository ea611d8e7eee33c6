"""Points on surfaces, and characters in the unit cube."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import MeshError
from ...geometry.triangles import normals
from ...rig.rig import Rig


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points on the faces of a mesh.

    Parameters
    ----------
    places : array, shape (p, 3), float64
    face : array, shape (p,), int64
    shares : array, shape (p, 3), float64
        Barycentric coordinates.
    """

    places: NDArray[np.float64]
    face: NDArray[np.int64]
    shares: NDArray[np.float64]


def sample_surface(vertices: ArrayLike, faces: ArrayLike, count: int, seed: int) -> SurfacePoints:
    """Draw points on a mesh, as many a face as its area asks for.

    Shapes: vertices (n, 3), faces (m, 3).
    """
    places, corners = np.asarray(vertices, np.float64), np.asarray(faces)
    a, b, c = (places[corners[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    total = area.cumsum()
    if not 0 < total[-1] < np.inf:
        raise MeshError("its faces have no area that points could be drawn on")
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
    """Return unit normals of the faces (m, 3) and of the vertices (n, 3); zero where none is."""
    places, corners = np.asarray(vertices, np.float64), np.asarray(faces)
    across = normals(places[corners])
    by_vertex = np.zeros((len(places), 3))
    for k in range(3):
        np.add.at(by_vertex, corners[:, k], across)
    return _unit(across), _unit(by_vertex)


def _unit(vectors: NDArray) -> NDArray[np.float32]:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0).astype("f4")


@dataclass(frozen=True, eq=False)
class Normalised:
    """A character in the unit cube, as the audit compares it.

    Parameters
    ----------
    joints : array, shape (j, 3), float32
    points : array, shape (p, 3), float32
        On the surface.
    """

    joints: NDArray[np.float32]
    points: NDArray[np.float32]


def normalised(rig: Rig, count: int, seed: int = 0) -> Normalised:
    """Scale a character into the unit cube, and draw points on it."""
    low, high = rig.mesh.bounds
    size, middle = float((high - low).max()), (low + high) / 2
    vertices = (rig.mesh.vertices - middle) / size + 0.5
    joints = (rig.skeleton.joints - middle) / size + 0.5
    points = sample_surface(vertices, rig.mesh.faces, count, seed).places
    # Rounding may put a point a little outside of the cube.
    return Normalised(joints.astype(np.float32), points.clip(0, 1).astype(np.float32))
