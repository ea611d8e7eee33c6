"""Distances to a body and tests for its inside from triangles alone, without a graph or kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.triangles import label_components, normals
from ..mesh import TriangleMesh

SURFACE_SPACING = 0.02
"""Distance of samples of the surface, in longest sides."""
CELL = SURFACE_SPACING / 2
"""Size of cells whose samples become one, in longest sides."""
MAX_SPLITS = 50
"""Along each side of a triangle, whatever its size."""
INSIDE_BODY = 0.3
"""Threshold of the winding number: open meshes are never whole."""
WELD = 1 << 20
"""Steps of a grid along the longest side: vertices in one cell are the same."""
PAIRS_TOGETHER = 2_000_000
"""Pairs of point and sample that are looked at together."""
MAX_SURFACE_SAMPLES = 10_000_000
"""Of large triangles in one place there may be any number: all are then cut less small."""


class Body:
    """Samples of the surface of a mesh, each with its area."""

    def __init__(self, mesh: TriangleMesh) -> None:
        low, high = mesh.bounds
        self.size = float((high - low).max())
        corners = _outward((mesh.vertices - low) / self.size, mesh.faces)
        self._low = low
        self._corners = corners
        self.points, self.areas = _samples(corners)
        self._tree = cKDTree(self.points)

    def to_unit(self, points: NDArray) -> NDArray[np.float64]:
        """Scale points so that the longest side of the body is one."""
        return (points - self._low) / self.size

    def to_surface(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Measure from points (p, 3) to the surface, to about `SURFACE_SPACING` / 2."""
        return np.asarray(self._tree.query(points)[0])

    def inside(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which points (p, 3) the surface encloses; `SURFACE_SPACING` from it at least."""
        winding = np.zeros(len(points))
        step = max(1, PAIRS_TOGETHER // len(self.points))
        for first in range(0, len(points), step):
            away = self.points - points[first : first + step, None]
            cubed = np.einsum("psi,psi->ps", away, away) ** 1.5
            covered = np.einsum("psi,si->ps", away, self.areas) / cubed
            winding[first : first + step] = covered.sum(axis=1)
        return winding > INSIDE_BODY * 4 * np.pi

    def away(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Measure from points (p, 3) to the body, 0 inside of it."""
        away = self.to_surface(points)
        deep = np.flatnonzero(away > SURFACE_SPACING)
        away[deep[self.inside(points[deep])]] = 0.0
        return away

    def encloses(self, point: NDArray[np.float64]) -> bool:
        """Return whether the surface encloses a point (3,), however close it is."""
        a, b, c = np.moveaxis(self._corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        volume = np.einsum("mi,mi->m", a, np.cross(b, c))
        dots = [np.einsum("mi,mi->m", x, y) for x, y in ((a, b), (b, c), (c, a))]
        below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
        return bool(np.arctan2(volume, below).sum() > INSIDE_BODY * 2 * np.pi)


def _outward(vertices: NDArray[np.float64], faces: NDArray) -> NDArray[np.float64]:
    """Return corners (m, 3, 3) of triangles, turned where their connected part is inside out."""
    grid = np.rint(vertices * WELD).astype(np.int64) @ [1 << 42, 1 << 21, 1]
    welded = np.unique(grid, return_inverse=True)[1][faces]
    part = label_components(welded, len(vertices))[welded[:, 0]]
    corners = vertices[faces]
    sums = np.stack([np.bincount(part, x) for x in corners.mean(axis=1).T], axis=1)
    middles = sums / np.maximum(np.bincount(part), 1)[:, None]
    away = corners - middles[part, None]
    volume = np.einsum("mi,mi->m", away[:, 0], np.cross(away[:, 1], away[:, 2]))
    inside_out = np.bincount(part, volume)[part] < 0
    return np.where(inside_out[:, None, None], corners[:, ::-1], corners)


def _samples(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut triangles (m, 3, 3) into equal ones that are small; return middles and area vectors.

    Samples in each cell of a grid are merged, so that fine meshes have no more than coarse.
    """
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    splits = np.clip(np.ceil(sides / SURFACE_SPACING), 1, MAX_SPLITS)
    excess = max(1, np.sqrt((splits**2).sum() / MAX_SURFACE_SAMPLES))
    splits = np.maximum(splits / excess, 1).astype(int)
    order = np.argsort(splits, kind="stable")
    block = np.cumsum(splits[order] ** 2) // (PAIRS_TOGETHER // 4)
    sums = np.empty((0, 7))  # of each cell: the sums of its points and areas, and their number
    for some in np.split(order, np.flatnonzero(np.diff(block)) + 1):
        sums = np.concatenate([sums, _cut(corners[some], splits[some])])
        cell = np.floor(sums[:, :3] / sums[:, 6:] / CELL).astype(np.int64)
        where = np.unique(cell @ [1 << 42, 1 << 21, 1], return_inverse=True)[1]
        sums = np.stack([np.bincount(where, column) for column in sums.T], axis=1)
    return sums[:, :3] / sums[:, 6:], sums[:, 3:6]


def _cut(corners: NDArray[np.float64], splits: NDArray[np.int_]) -> NDArray[np.float64]:
    """Cut triangles into splits² equal ones; return middles, area vectors and ones, (s, 7)."""
    rows, area = [], normals(corners) / 2
    for n in np.unique(splits):
        is_split = splits == n
        weights = _middles(int(n))
        points = np.einsum("sc,mci->msi", weights, corners[is_split]).reshape(-1, 3)
        areas = np.repeat(area[is_split] / n**2, len(weights), axis=0)
        rows.append(np.column_stack([points, areas, np.ones(len(points))]))
    return np.concatenate(rows)


def _middles(splits: int) -> NDArray[np.float64]:
    """Return barycentric coordinates of the middles of a triangle's splits² parts."""
    i, j = (x.ravel() for x in np.mgrid[:splits, :splits])
    up = np.stack([i, j], axis=1)[i + j < splits] + 1 / 3
    down = np.stack([i, j], axis=1)[i + j < splits - 1] + 2 / 3
    first_two = np.concatenate([up, down]) / splits
    return np.column_stack([first_two, 1 - first_two.sum(axis=1)])
