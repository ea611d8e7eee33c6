"""Marks on a character: a ball at a vertex, a tube along a path."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Rig, TriangleMesh

from .character import OCTAHEDRON, bone_frames, diagonal, smooth_normals, to_scene
from .description import Actor
from .palette import MARK
from .skin import Skin

DOT = 4.0
"""Width of the marks of many vertices, in pixels of the screen."""
LIFT = 0.0008
"""Distance of the marks from the surface, relative to the diagonal of the character's box."""
BALL = 13.0
"""Width of a vertex's mark, in pixels of the screen."""
TUBE = 0.0035
"""A radius, in parts of the diagonal of the character's box."""


def vertex_mark(rig: Rig, vertex: int, weights: ArrayLike | None = None) -> Actor:
    """Return a ball at a vertex, drawn over everything; it follows the vertex's weights.

    It is as large on the screen from near as from far.
    """
    skin = None
    if weights is not None:
        skin = Skin.of_weights(np.asarray(weights, float)[[vertex]])
    place = to_scene(rig, rig.mesh.vertices[[vertex]])
    return Actor.dots(place, color=MARK, width=BALL, skin=skin, overlay=True)


def vertex_dots(body: Actor, vertices: ArrayLike) -> Actor:
    """Return dots on some vertices, shape (v,), of a body, which move with it."""
    chosen = np.asarray(vertices)
    assert body.normals is not None
    size = np.linalg.norm(np.ptp(body.points, axis=0))
    skin = body.skin and body.skin.subset(chosen)
    places = body.points[chosen] + LIFT * size * body.normals[chosen]
    return Actor.dots(places, color=MARK, width=DOT, skin=skin)


def outline(
    body: Actor, welded: NDArray[np.integer], inside: NDArray[np.bool_], **style: Any
) -> Actor:
    """Return lines around the triangles of a body that have vertices inside.

    They move with the body. Where the mesh ends there is no line.

    Parameters
    ----------
    body : Actor
    welded : array, shape (n,)
        The welded vertex of each vertex: copies at a seam are one.
    inside : array, shape (n,), bool
    **style
        Other fields of the lines' `Actor`.
    """
    assert body.normals is not None
    at_place = np.zeros(int(welded.max()) + 1, np.bool_)
    at_place[welded[inside]] = True
    cells = welded[body.cells]
    corners = at_place[cells]
    inner = corners @ np.ones(3, np.uint8)  # quicker than a sum along an axis of three
    near = np.zeros_like(at_place)
    near[cells[(inner > 0) & (inner < 3)]] = True
    # Only triangles beside the border: sorting the edges of all takes long.
    is_near = np.flatnonzero(near[cells] @ np.ones(3, np.uint8) >= 2)
    beside = body.cells[is_near]
    ends = np.stack([beside, np.roll(beside, -1, axis=1)], axis=2).reshape(-1, 2)
    low, high = np.sort(welded[ends], axis=1).T
    code = low.astype(np.int64) * len(at_place) + high
    _, first, edge = np.unique(code, return_index=True, return_inverse=True)
    is_inside = np.repeat(corners[is_near].any(axis=1), 3)
    of_inside, of_outside = (np.bincount(edge, flags) > 0 for flags in (is_inside, ~is_inside))
    around = ends[first[of_inside & of_outside]].ravel()
    size = np.linalg.norm(np.ptp(body.points, axis=0))
    lifted = body.points[around] + LIFT * size * body.normals[around]
    skin = body.skin and body.skin.subset(around)
    return Actor.segments(lifted.reshape(-1, 2, 3), skin=skin, **style)


def path_tube(rig: Rig, path: ArrayLike) -> Actor:
    """Return a tube along a path (p, 3) in the scene's space."""
    points, faces = tube(np.asarray(path, float), TUBE * diagonal(rig))
    index = TriangleMesh(points, faces).welded.index
    return Actor.solid(points, faces, normals=smooth_normals(points, faces, index), color=MARK)


def tube(path: NDArray[np.float64], radius: float, sides: int = 10) -> tuple[NDArray, NDArray]:
    """Return the points and triangles of open tubes along a path, with balls at its points."""
    ball, ball_faces = _ball()
    balls = path[:, None] + radius * ball
    _, _, side, other = bone_frames(path[:-1], path[1:])
    angle = 2 * np.pi * np.arange(sides)[:, None] / sides
    ring = np.cos(angle) * side[:, None] + np.sin(angle) * other[:, None]
    tubes, tube_faces = _prisms(path[:-1], path[1:], radius * ring)
    between = np.arange(len(path))[:, None, None] * len(ball) + ball_faces
    faces = np.concatenate([between.reshape(-1, 3), balls.shape[0] * len(ball) + tube_faces])
    return np.concatenate([balls.reshape(-1, 3), tubes]), faces


def rods(
    start: NDArray[np.float64], end: NDArray[np.float64], thickness: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.intp], NDArray[np.intp]]:
    """Return square rods along segments: points, triangles, and the segment of each point."""
    _, _, side, other = bone_frames(start, end)
    half = np.broadcast_to(thickness, len(start))[:, None] / 2
    ring = [half * (a * side + b * other) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return *_prisms(start, end, np.stack(ring, axis=1)), np.repeat(np.arange(len(start)), 8)


def beads(centres: NDArray[np.float64], radius: float) -> tuple[NDArray, NDArray]:
    """Return the points and triangles of an octahedron at each centre (c, 3)."""
    x, y, z = np.eye(3)
    points = centres[:, None] + radius * np.stack([-z, x, y, -x, -y, z])
    faces = 6 * np.arange(len(centres))[:, None, None] + OCTAHEDRON
    return points.reshape(-1, 3), faces.reshape(-1, 3)


def _prisms(
    start: NDArray[np.float64], end: NDArray[np.float64], ring: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return open prisms along segments (s, 3), with rings at offsets (s, k, 3) from both ends."""
    points = np.concatenate([start[:, None] + ring, end[:, None] + ring], axis=1)
    count = ring.shape[1]
    k = np.arange(count)
    after = (k + 1) % count
    sides = np.stack([k, after, k + count, after, after + count, k + count], axis=1)
    faces = 2 * count * np.arange(len(start))[:, None, None] + sides.reshape(-1, 3)
    return points.reshape(-1, 3), faces.reshape(-1, 3)


def _ball(rows: int = 7, columns: int = 12) -> tuple[NDArray, NDArray]:
    """Return the points and triangles of a ball of radius 1."""
    up = np.pi * np.arange(1, rows)[:, None] / rows
    around = 2 * np.pi * np.arange(columns) / columns
    x, z = np.sin(up) * np.cos(around), np.sin(up) * np.sin(around)
    inner = np.stack([x, np.broadcast_to(np.cos(up), x.shape), z], axis=2).reshape(-1, 3)
    points = np.concatenate([inner, [[0, 1, 0], [0, -1, 0]]])
    ring = np.arange(len(inner)).reshape(x.shape)
    after = np.roll(ring, -1, axis=1)
    faces = [
        (ring[0], len(inner), after[0]),
        (ring[-1], after[-1], len(inner) + 1),
        (ring[:-1], after[:-1], ring[1:]),
        (after[:-1], after[1:], ring[1:]),
    ]
    corners = [np.stack(np.broadcast_arrays(*three), axis=-1).reshape(-1, 3) for three in faces]
    return points, np.concatenate(corners)
