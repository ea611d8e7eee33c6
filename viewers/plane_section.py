"""The section of a mesh by a plane, with its exact outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import Delaunay, QhullError, cKDTree

from cutcell.geometry.triangles import face_edges
from cutcell.graph.winding import winding_number
from cutcell.rig import TriangleMesh

MARGIN = 0.04
"""Margin around the body, relative to its longest side."""
ROUNDS = 6
"""Times that pieces of the outline that are no edges of the triangulation are halved."""
CLEAR = 0.55
"""Smallest distance of the grid's points from the outline, in spacings."""
SHORT = 0.02
"""Length of pieces that are not halved further, in spacings."""
PULLED = 0.02
"""Part of the way to a triangle's centre at which its corners are queried: all on one side."""
WHOLE = 1e-6
"""Largest difference of a winding number from an integer that is rounded off."""
WELDED = 1e-9
"""Distance within which points are merged, relative to the longest side."""


@dataclass(frozen=True, eq=False)
class PlaneSection:
    """The section of a mesh by a plane, in triangles of which none crosses the outline.

    Parameters
    ----------
    points : array, shape (p, 3), float64
    faces : array, shape (t, 3), int64
        They fill a box around the body, and face along the plane's normal.
    winding : array, shape (t, 3), float64
        The winding number at the corners of each, on its side of the outline.
    outline : array, shape (s, 2, 3), float64
        The intersection of the plane and the mesh.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.int64]
    winding: NDArray[np.float64]
    outline: NDArray[np.float64]

    def above(
        self, threshold: float
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
        """Return the part whose winding number is at least a threshold.

        Returns
        -------
        points : array, shape (q, 3), float64
        faces : array, shape (r, 3), int64
        contour : array, shape (c, 2, 3), float64
            The border where the number varies continuously, as it does at holes.
        """
        above = self.winding >= threshold
        count = above.sum(axis=1)
        corners, polygons, contour = [self.points], [self.faces[count == 3]], [np.empty((0, 2, 3))]
        used = len(self.points)
        for k in (1, 2):  # corners above; the odd one out comes first
            chosen = np.flatnonzero(count == k)
            odd = np.argmax(above[chosen] == (k == 1), axis=1)
            order = (odd[:, None] + np.arange(3)) % 3
            places = self.points[np.take_along_axis(self.faces[chosen], order, axis=1)]
            values = np.take_along_axis(self.winding[chosen], order, axis=1) - threshold
            part = values[:, :1] / (values[:, :1] - values[:, 1:])
            crossings = places[:, :1] + part[:, :, None] * (places[:, 1:] - places[:, :1])
            contour.append(crossings)
            ends = [places[:, :1], crossings] if k == 1 else [crossings[:, ::-1], places[:, 1:]]
            ring = np.concatenate(ends, axis=1)
            index = used + np.arange(len(ring) * (k + 2)).reshape(len(ring), k + 2)
            corners.append(ring.reshape(-1, 3))
            polygons += [index[:, fan] for fan in ([0, 1, 2], [0, 2, 3])[:k]]
            used += index.size
        points, faces = np.concatenate(corners), np.concatenate(polygons)
        used_points, faces = np.unique(faces, return_inverse=True)
        return points[used_points], faces.reshape(-1, 3), np.concatenate(contour)


def plane_section(
    mesh: TriangleMesh, origin: ArrayLike, normal: ArrayLike, resolution: int
) -> PlaneSection:
    """Compute the section of a mesh by a plane.

    Parameters
    ----------
    mesh : TriangleMesh
    origin, normal : array_like, shape (3,)
        A point of the plane, and a unit vector perpendicular to it.
    resolution : int
        Triangles along the longest side of the body, about.
    """
    origin, normal = np.asarray(origin, float), np.asarray(normal, float)
    size = float(np.ptp(mesh.bounds, axis=0).max())
    outline = plane_outline(mesh.vertices, mesh.faces, origin, normal)
    _, first, ends = np.unique(
        np.round(outline.reshape(-1, 3) / (WELDED * size)),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    pieces = ends.reshape(-1, 2)
    pieces = pieces[pieces[:, 0] != pieces[:, 1]]
    u = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    u /= np.linalg.norm(u)
    plane = np.stack([u, np.cross(normal, u)])
    flat = (outline.reshape(-1, 3)[first] - origin) @ plane.T
    flat, faces = _triangulate(flat, pieces, size / resolution, MARGIN * size)
    points = origin + flat @ plane
    return PlaneSection(points, faces, _winding(mesh, points, faces), outline)


def plane_outline(
    vertices: NDArray[np.float64],
    faces: NDArray[np.integer],
    origin: NDArray[np.float64],
    normal: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the intersection of triangles (m, 3) and a plane, shape (s, 2, 3)."""
    height = (vertices - origin) @ normal
    above = height[faces] >= 0
    crosses = above != np.roll(above, -1, axis=1)
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2)[crosses]
    a, b = np.sort(edges, axis=1).T  # so that both faces of an edge have the same point
    part = (height[a] / (height[a] - height[b]))[:, None]
    return (vertices[a] + part * (vertices[b] - vertices[a])).reshape(-1, 2, 3)


def _triangulate(
    points: NDArray[np.float64], pieces: NDArray[np.int64], spacing: float, margin: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangulate a box around an outline, each of whose pieces becomes an edge.

    Pieces that are no edges are halved until they are. Those that cross others, as where parts of
    a body overlap, never are, and end up tiny.
    """
    if len(points) < 3:
        return np.empty((0, 2)), np.empty((0, 3), np.int64)
    while (is_long := _lengths(points, pieces) > spacing).any():
        points, pieces = _halve(points, pieces, is_long)
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    points = np.concatenate([points, _grid_around(points, low, high, spacing)])
    faces = _delaunay(points)
    for _ in range(ROUNDS):
        edges, sides = face_edges(faces), np.sort(pieces, axis=1)
        is_edge = np.isin(sides @ [len(points), 1], edges @ [len(points), 1])
        is_missing = ~is_edge & (_lengths(points, pieces) > SHORT * spacing)
        if not is_missing.any():
            break
        points, pieces = _halve(points, pieces, is_missing)
        faces = _delaunay(points)
    return points, faces


def _lengths(points: NDArray[np.float64], pieces: NDArray[np.int64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.norm(points[pieces[:, 0]] - points[pieces[:, 1]], axis=1))


def _halve(
    points: NDArray[np.float64], pieces: NDArray[np.int64], chosen: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    start, end = pieces[chosen].T
    middle = len(points) + np.arange(len(start))
    halves = [np.stack([start, middle], axis=1), np.stack([middle, end], axis=1)]
    points = np.concatenate([points, (points[start] + points[end]) / 2])
    return points, np.concatenate([pieces[~chosen], *halves])


def _grid_around(
    points: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    spacing: float,
) -> NDArray[np.float64]:
    """Return the points of a grid of equal triangles that are not too near to others."""
    rows = np.arange(low[1], high[1] + spacing, spacing * np.sqrt(3) / 2)
    columns = np.arange(low[0], high[0] + spacing, spacing)
    x, y = np.meshgrid(columns, rows)
    x = x + 0.5 * spacing * (np.arange(len(rows))[:, None] % 2)
    grid = np.stack([x.ravel(), y.ravel()], axis=1)
    distance, _ = cKDTree(points).query(grid, distance_upper_bound=CLEAR * spacing)
    return grid[np.isinf(distance)]


def _delaunay(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Triangulate points (n, 2), counter-clockwise."""
    try:
        faces = Delaunay(points).simplices.astype(np.int64)
    except QhullError:
        return np.empty((0, 3), np.int64)
    (ax, ay), (bx, by) = (points[faces[:, k]].T - points[faces[:, 0]].T for k in (1, 2))
    return np.where((ax * by < bx * ay)[:, None], faces[:, [0, 2, 1]], faces)


def _winding(
    mesh: TriangleMesh, points: NDArray[np.float64], faces: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the winding number at the corners of triangles (t, 3), on their side."""
    corners = points[faces]
    centre = corners.mean(axis=1)
    number = winding_number(mesh, centre)
    if not len(number) or np.abs(number - np.round(number)).max() < WHOLE:
        return np.repeat(np.round(number)[:, None], 3, axis=1)
    inward = corners + PULLED * (centre[:, None] - corners)
    return winding_number(mesh, inward.reshape(-1, 3)).reshape(-1, 3)
