"""Where a plane meets the mesh itself: the outline, exactly, and what lies inside it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError, cKDTree

from cutcell.graph.winding import winding_number
from cutcell.rig import Rig, TriangleMesh

from .character import to_scene
from .description import Cut

COARSEST, FINEST = 72, 128
"""Triangles of a section along the longest side of the body."""
MARGIN = 0.04
"""Margin around the body in which the winding number is drawn, relative to its longest side."""
ROUNDS = 6
"""How often pieces of the outline that are no edges of the triangulation are halved."""
CLEAR = 0.55
"""How far from the outline other points stay, in spacings."""
PULLED = 0.02
"""How far towards a triangle's centre its corners are asked for, so that they are on one side."""
WHOLE = 1e-6
"""Largest difference of a winding number from an integer that is rounded off."""
WELDED = 1e-9
"""Places that are nearer than this, in parts of the longest side, are one."""


@dataclass(frozen=True, eq=False)
class PlaneSection:
    """The section of a mesh by a plane, in triangles of which none crosses the outline.

    Parameters
    ----------
    points : array, shape (p, 3), float64
        In the scene, in the plane.
    faces : array, shape (t, 3), int64
        They fill a box around the body.
    winding : array, shape (t, 3), float64
        The winding number at the corners of each, on its side of the outline.
    outline : array, shape (s, 2, 3), float64
        Where the plane meets the faces of the mesh.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.int64]
    winding: NDArray[np.float64]
    outline: NDArray[np.float64]


def plane_section(rig: Rig, mesh: TriangleMesh, cut: Cut, resolution: int) -> PlaneSection:
    """Compute the section of a mesh by a plane.

    Parameters
    ----------
    rig : Rig
        Transformation of its space into the scene.
    mesh : TriangleMesh
        The rig's, or that with its inverted faces flipped.
    cut : Cut
        The plane, in the scene.
    resolution : int
        Triangles along the longest side of the body, about.
    """
    vertices = to_scene(rig, mesh.vertices)
    origin, (u, v) = np.array(cut.origin), in_plane(np.array(cut.normal))
    size = float(np.ptp(vertices[np.unique(mesh.faces)], axis=0).max())
    places, pieces = _outline(vertices, mesh.faces, cut, WELDED * size)
    outline = places[pieces]
    flat = np.stack([(places - origin) @ u, (places - origin) @ v], axis=1)
    points, faces = _triangles(flat, pieces, size / resolution, MARGIN * size)
    placed = origin + points[:, :1] * u + points[:, 1:] * v
    winding = _winding(rig, mesh, placed, faces)
    return PlaneSection(placed, faces, winding, outline)


def in_plane(normal: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two directions of length 1 that span the plane of a normal, at right angles."""
    other = np.eye(3)[int(np.argmin(np.abs(normal)))]
    u = np.cross(normal, other)
    u /= np.linalg.norm(u)
    v = np.cross(normal, u)
    return u, v / np.linalg.norm(v)


def part_above(
    section: PlaneSection, threshold: float
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Return the part of a section whose winding number is at least some value.

    Returns
    -------
    points : array, shape (q, 3), float64
    faces : array, shape (r, 3), int64
    contour : array, shape (c, 2, 3), float64
        Where the number passes that value continuously, as it does at open places.
    """
    above = section.winding >= threshold
    count = above.sum(axis=1)
    whole = section.faces[count == 3]
    corners, polygons, contour = [section.points], [whole], [np.empty((0, 2, 3))]
    used = len(section.points)
    for k in (1, 2):  # how many corners are above; the odd one out comes first
        these = np.flatnonzero(count == k)
        odd = np.argmax(above[these] == (k == 1), axis=1)
        order = (odd[:, None] + np.arange(3)) % 3
        place = section.points[np.take_along_axis(section.faces[these], order, axis=1)]
        value = np.take_along_axis(section.winding[these], order, axis=1) - threshold
        part = value[:, :1] / (value[:, :1] - value[:, 1:])
        meets = place[:, :1] + part[:, :, None] * (place[:, 1:] - place[:, :1])
        contour.append(meets)
        ends = [place[:, :1], meets] if k == 1 else [meets[:, ::-1], place[:, 1:]]
        ring = np.concatenate(ends, axis=1)
        at = used + np.arange(len(ring) * ring.shape[1]).reshape(len(ring), ring.shape[1])
        fans = ([0, 1, 2],) if k == 1 else ([0, 1, 2], [0, 2, 3])
        corners.append(ring.reshape(-1, 3))
        polygons += [at[:, fan] for fan in fans]
        used += at.size
    points, faces = np.concatenate(corners), np.concatenate(polygons)
    crossed, again = np.unique(faces, return_inverse=True)
    return points[crossed], again.reshape(-1, 3), np.concatenate(contour)


def _outline(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], cut: Cut, tolerance: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the ends of the pieces of an outline, and which two each piece joins."""
    height = (vertices - np.array(cut.origin)) @ np.array(cut.normal)
    above = height[faces] >= 0
    met = above.any(axis=1) & ~above.all(axis=1)
    corners, above = faces[met], above[met]
    edges, crossed = [], []
    for k in range(3):
        pair = np.stack([corners[:, k], corners[:, (k + 1) % 3]], axis=1)
        edges.append(np.sort(pair, axis=1))  # both faces of an edge work out the same place
        crossed.append(above[:, k] != above[:, (k + 1) % 3])
    chosen = np.stack(crossed, axis=1)
    pairs = np.stack(edges, axis=1)[chosen]
    if not len(pairs):
        return np.empty((0, 3)), np.empty((0, 2), np.int64)
    a, b = pairs.T
    part = (height[a] / (height[a] - height[b]))[:, None]
    places = vertices[a] + part * (vertices[b] - vertices[a])
    _, first, index = np.unique(
        np.round(places / tolerance), axis=0, return_index=True, return_inverse=True
    )
    pieces = index.reshape(-1, 2)
    return places[first], pieces[pieces[:, 0] != pieces[:, 1]]


def _triangles(
    places: NDArray[np.float64], pieces: NDArray[np.int64], spacing: float, margin: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangulate a box around an outline, of whose pieces each becomes an edge.

    Pieces that are none are halved until they are: those that cross others, as where parts of a
    body overlap, stay so, and end up tiny.
    """
    if len(places) < 3:
        return np.empty((0, 2)), np.empty((0, 3), np.int64)
    points, pieces = _divided(places, pieces, spacing)
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    points = np.concatenate([points, _around(points, low, high, spacing)])
    faces = _delaunay(points)
    for _ in range(ROUNDS):
        missing = ~_are_edges(faces, pieces, len(points))
        length = np.linalg.norm(points[pieces[:, 0]] - points[pieces[:, 1]], axis=1)
        missing &= length > 0.02 * spacing
        if not missing.any():
            break
        points, pieces = _halved(points, pieces, missing)
        faces = _delaunay(points)
    return points, faces


def _divided(
    points: NDArray[np.float64], pieces: NDArray[np.int64], spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    while True:
        length = np.linalg.norm(points[pieces[:, 0]] - points[pieces[:, 1]], axis=1)
        if not (long := length > spacing).any():
            return points, pieces
        points, pieces = _halved(points, pieces, long)


def _halved(
    points: NDArray[np.float64], pieces: NDArray[np.int64], which: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    halves = pieces[which]
    middle = points[halves].mean(axis=1)
    new = len(points) + np.arange(len(middle))
    parts = [pieces[~which], np.stack([halves[:, 0], new], 1), np.stack([new, halves[:, 1]], 1)]
    return np.concatenate([points, middle]), np.concatenate(parts)


def _around(
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
    near, _ = cKDTree(points).query(grid, distance_upper_bound=CLEAR * spacing)
    return grid[np.isinf(near)]


def _delaunay(points: NDArray[np.float64]) -> NDArray[np.int64]:
    try:
        faces = Delaunay(points).simplices.astype(np.int64)
    except QhullError:
        return np.empty((0, 3), np.int64)
    one, other = (
        points[faces[:, 1]] - points[faces[:, 0]],
        points[faces[:, 2]] - points[faces[:, 0]],
    )
    backward = one[:, 0] * other[:, 1] < one[:, 1] * other[:, 0]
    return np.where(backward[:, None], faces[:, [0, 2, 1]], faces)  # all look along the normal


def _are_edges(
    faces: NDArray[np.int64], pieces: NDArray[np.int64], count: int
) -> NDArray[np.bool_]:
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    sides = np.sort(pieces, axis=1)
    return np.isin(sides @ [count, 1], edges @ [count, 1])


def _winding(
    rig: Rig, mesh: TriangleMesh, points: NDArray[np.float64], faces: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the winding number at the corners of triangles (t, 3), on their side."""
    corners = points[faces]
    centre = corners.mean(axis=1)
    number = winding_number(mesh, from_scene(rig, centre))
    if not len(number) or np.abs(number - np.round(number)).max() < WHOLE:
        return np.repeat(np.round(number)[:, None], 3, axis=1)
    inward = corners + PULLED * (centre[:, None] - corners)
    return winding_number(mesh, from_scene(rig, inward.reshape(-1, 3))).reshape(-1, 3)


def from_scene(rig: Rig, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bring points (n, 3) of the scene back into the rig's own units."""
    return np.asarray(np.linalg.solve(rig.world[:3, :3], (points - rig.world[:3, 3]).T).T, float)
