"""From a signed distance field to a closed mesh: sample, march, remesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from .body import Body, neighbourhoods
from .remesh import collapse_short_edges, flip_edges, split_long_edges

BLOCK = 16
"""Lattice points along a side of the blocks that are sampled, or skipped, as one."""

GRID = 1e-7
"""Positions are rounded to this, to swallow the last bits in which machines may differ."""


def mesh_of(
    body: Body, lower: NDArray, upper: NDArray, spacing: float, detail: float = 1.0
) -> tuple[NDArray, NDArray]:
    """Mesh a body's surface.

    Parameters
    ----------
    body : Body
    lower, upper : array, shape (3,)
        Opposite corners of a box around it.
    spacing : float
        Distance of the samples; less than its narrowest gap and thinnest limb.
    detail : float
        Factor on the wanted edge lengths.

    Returns
    -------
    vertices : array, shape (n, 3), float64
    faces : array, shape (m, 3), int64
        Closed, and counter-clockwise seen from outside.
    """
    from skimage.measure import marching_cubes

    values = _sample(body, lower, upper, spacing)
    vertices, faces, _, _ = marching_cubes(values, 0.0, gradient_direction="ascent")
    vertices = np.round((vertices.astype(float) * spacing + lower) / GRID) * GRID
    faces = faces.astype(np.int64)
    if _volume(vertices, faces) < 0:
        faces = faces[:, ::-1]
    vertices, faces = _without_specks(vertices, faces)
    vertices, faces = _without_slivers(vertices, faces, spacing)
    return remeshed(body, vertices, faces, detail)


def remeshed(
    body: Body, vertices: NDArray, faces: NDArray, detail: float = 1.0, passes: int = 6
) -> tuple[NDArray, NDArray]:
    """Give a mesh of a body the edge lengths that the body wants, and even triangles.

    Each pass splits long edges, collapses short ones, flips edges towards six triangles a
    vertex, lets the vertices slide on the surface, and puts them back on it
    (Botsch & Kobbelt 2004, "A remeshing approach to multiresolution modeling").
    """
    for step in range(passes):
        wanted = detail * body.edge_length(vertices)
        if step:
            vertices, faces, wanted = split_long_edges(vertices, faces, wanted)
        vertices, faces, wanted = collapse_short_edges(vertices, faces, wanted)
        faces = flip_edges(vertices, faces)
        for _ in range(2):
            vertices = relaxed(relaxed(vertices, faces, wanted), faces, wanted)
            vertices = onto_surface(body, vertices)
    return vertices, flip_edges(vertices, faces)


def normals_of(body: Body, vertices: NDArray, step: float = 1e-4) -> NDArray:
    """Return the field's unit gradient at each vertex, shape (n, 3): smooth normals."""
    normals, _, _ = _gradient(body, vertices, step)
    return normals


def face_vectors(vertices: NDArray, faces: NDArray) -> NDArray:
    """Return each face's normal, as long as twice its area, shape (m, 3)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _sample(body: Body, lower: NDArray, upper: NDArray, spacing: float) -> NDArray:
    blocks = np.ceil((upper - lower) / spacing / BLOCK).astype(int)
    values = np.empty(blocks * BLOCK, np.float32)
    local = np.stack(np.meshgrid(*[np.arange(BLOCK)] * 3, indexing="ij"), -1).reshape(-1, 3)
    reach = spacing * BLOCK * 0.9  # more than from a block's centre to its corner
    for block in np.ndindex(*blocks):
        start = np.array(block) * BLOCK
        where = tuple(slice(s, s + BLOCK) for s in start)
        centre = lower + (start + (BLOCK - 1) / 2) * spacing
        middle = float(body.distance(centre[None])[0])
        if abs(middle) > 1.5 * reach:  # ellipsoids' distances are estimates: keep a margin
            values[where] = middle
            continue
        points = lower + (start + local) * spacing
        values[where] = body.distance(points).reshape(BLOCK, BLOCK, BLOCK)
    # A sample exactly on the surface would make triangles without area.
    values[np.abs(values) < 1e-5 * spacing] = 1e-5 * spacing
    return values


def _without_specks(vertices: NDArray, faces: NDArray) -> tuple[NDArray, NDArray]:
    """Keep the largest piece: where a carving ends thin, crumbs smaller than a cell remain."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    links = sparse.coo_array((np.ones(len(start)), (start, end)), shape=(len(vertices),) * 2)
    _, piece = connected_components(links, directed=False)
    alive = piece == np.bincount(piece).argmax()
    number = np.cumsum(alive) - 1
    return vertices[alive], number[faces[alive[faces[:, 0]]]]


def _without_slivers(vertices: NDArray, faces: NDArray, spacing: float) -> tuple[NDArray, NDArray]:
    wanted = np.full(len(vertices), 0.6 * spacing)
    vertices, faces, _ = collapse_short_edges(vertices, faces, wanted, rounds=6)
    return vertices, faces


def relaxed(vertices: NDArray, faces: NDArray, wanted: NDArray) -> NDArray:
    """Slide each vertex half the way to its triangles' middle, weighted by their area."""
    count = len(vertices)
    vectors = face_vectors(vertices, faces)
    size = wanted[faces].mean(axis=1)
    weight = np.sqrt((vectors**2).sum(axis=1)) / size**2
    middle = vertices[faces].mean(axis=1) * weight[:, None]
    corners = faces.ravel()
    total = np.bincount(corners, np.repeat(weight, 3), count)
    goal = _sum_at(corners, np.repeat(middle, 3, axis=0), count) / total[:, None]
    normal = _sum_at(corners, np.repeat(vectors, 3, axis=0), count)
    normal /= np.sqrt((normal**2).sum(axis=1, keepdims=True))
    move = goal - vertices
    move -= normal * (move * normal).sum(axis=1, keepdims=True)
    return vertices + 0.6 * move


def onto_surface(body: Body, vertices: NDArray) -> NDArray:
    """Return the vertices put back on the body's surface."""
    normal, slope, value = _gradient(body, vertices, 1e-4)
    # Where limbs meet in a crease the slope is unreliable: never step further than 1 cm.
    step = np.clip(value / np.maximum(slope, 0.3), -0.01, 0.01)
    return np.round((vertices - normal * step[:, None]) / GRID) * GRID


def _gradient(body: Body, vertices: NDArray, step: float) -> tuple[NDArray, NDArray, NDArray]:
    """Return unit gradient, slope and value, from four samples at a tetrahedron's corners."""
    corners = np.array([[1, -1, -1], [-1, -1, 1], [-1, 1, -1], [1, 1, 1]], float)
    gradient, value = np.zeros_like(vertices), np.zeros(len(vertices))
    for rows in neighbourhoods(vertices):
        for corner in corners:
            sample = body.distance(vertices[rows] + step * corner)
            gradient[rows] += sample[:, None] * corner / (4 * step)
            value[rows] += sample / 4
    slope = np.sqrt((gradient**2).sum(axis=1))
    return gradient / np.maximum(slope, 1e-9)[:, None], slope, value


def _sum_at(index: NDArray, rows: NDArray, count: int) -> NDArray:
    return np.stack([np.bincount(index, column, count) for column in rows.T], axis=1)


def _volume(vertices: NDArray, faces: NDArray) -> float:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6)
