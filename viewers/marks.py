"""Marks on a character: a ball at a vertex, a tube along a path."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Rig

from .character import across, smooth_normals, to_scene
from .description import Actor
from .palette import MARK
from .skin import Skin, skin_of_weights

DOT = 4.0
"""How wide the marks of many vertices are, in pixels of the screen."""
LIFT = 0.0008
"""Distance of the marks from the surface, relative to the diagonal of the character's box."""
BALL = 13.0
"""How wide a vertex's mark is, in pixels of the screen."""
TUBE = 0.0035
"""A radius, in parts of the diagonal of the character's box."""


def vertex_mark(rig: Rig, vertex: int, weights: ArrayLike | None = None) -> Actor:
    """Return a ball at a vertex, drawn over everything; it follows the vertex's weights.

    It is as large on the screen from near as from far.
    """
    skin = None
    if weights is not None:
        skin = skin_of_weights(np.asarray(weights, float)[[vertex]])
    return Actor(
        "points",
        to_scene(rig, rig.mesh.vertices[[vertex]]).astype(np.float32),
        np.zeros((1, 1), np.int32),
        color=MARK,
        width=BALL,
        skin=skin,
        overlay=True,
        clipped=False,
    )


def vertex_dots(body: Actor, vertices: ArrayLike) -> Actor:
    """Return dots on some vertices, shape (v,), of a body, which move with it."""
    chosen = np.asarray(vertices)
    assert body.normals is not None
    size = np.linalg.norm(np.ptp(body.points, axis=0))
    skin = None
    if body.skin is not None:
        skin = Skin(body.skin.joints[chosen], body.skin.weights[chosen])
    return Actor(
        "points",
        (body.points[chosen] + LIFT * size * body.normals[chosen]).astype(np.float32),
        np.arange(len(chosen), dtype=np.int32)[:, None],
        color=MARK,
        width=DOT,
        skin=skin,
        clipped=False,
    )


def path_tube(rig: Rig, path: ArrayLike) -> Actor:
    """Return a tube along a path (p, 3) in the scene's space."""
    points, faces = tube(np.asarray(path, float), TUBE * _size(rig))
    return Actor(
        "surface",
        points.astype(np.float32),
        faces,
        normals=smooth_normals(points, faces).astype(np.float32),
        color=MARK,
        clipped=False,
    )


def tube(path: NDArray[np.float64], radius: float, sides: int = 10) -> tuple[NDArray, NDArray]:
    """Return the points and triangles of one open tube a piece of a path, with balls between."""
    ball, ball_faces = _ball()
    points = [path[:, None] + radius * ball]
    faces = [np.arange(len(path))[:, None, None] * len(ball) + ball_faces]
    start, along = path[:-1], np.diff(path, axis=0)
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 0, along / np.where(length > 0, length, 1), [0.0, 1, 0])
    side, other = across(along)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[:, None] * side[:, None] + np.sin(angle)[:, None] * other[:, None]
    rings = np.stack([start[:, None] + radius * ring, path[1:, None] + radius * ring], axis=1)
    points.append(rings.reshape(len(start), -1, 3))
    k = np.arange(sides)
    after = (k + 1) % sides
    strip = np.stack([k, after, k + sides, after, after + sides, k + sides], axis=1)
    first = len(path) * len(ball)
    offset = first + np.arange(len(start)) * 2 * sides
    faces.append(offset[:, None, None] + strip.reshape(-1, 3))
    return (
        np.concatenate([p.reshape(-1, 3) for p in points]),
        np.concatenate([f.reshape(-1, 3) for f in faces]).astype(np.int32),
    )


def rods(
    start: NDArray[np.float64], end: NDArray[np.float64], thickness: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.intp]]:
    """Return one square rod a piece (s, 3): points, triangles, and the piece of each point."""
    along = end - start
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 0, along / np.where(length > 0, length, 1), [0.0, 1, 0])
    side, other = across(along)
    half = np.broadcast_to(thickness, len(start))[:, None] / 2
    ring = [half * (a * side + b * other) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    points = np.stack([*(start + r for r in ring), *(end + r for r in ring)], axis=1)
    k = np.arange(4)
    after = (k + 1) % 4
    sides = np.stack([k, after, k + 4, after, after + 4, k + 4], axis=1).reshape(-1, 3)
    faces = 8 * np.arange(len(start))[:, None, None] + sides
    of = np.repeat(np.arange(len(start)), 8)
    return points.reshape(-1, 3), faces.reshape(-1, 3).astype(np.int32), of


def beads(centres: NDArray[np.float64], radius: float) -> tuple[NDArray, NDArray]:
    """Return the points and triangles of an octahedron at each centre (c, 3)."""
    points = centres[:, None] + radius * _OCTAHEDRON
    faces = 6 * np.arange(len(centres))[:, None, None] + _OCTAHEDRON_FACES
    return points.reshape(-1, 3), faces.reshape(-1, 3).astype(np.int32)


_OCTAHEDRON = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1.0]])
_OCTAHEDRON_FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)


def _ball(rows: int = 7, columns: int = 12) -> tuple[NDArray, NDArray]:
    """Return the points and triangles of a ball of radius 1."""
    up = np.pi * np.arange(1, rows) / rows
    around = 2 * np.pi * np.arange(columns) / columns
    inner = np.stack(
        [
            np.outer(np.sin(up), np.cos(around)),
            np.outer(np.cos(up), np.ones(columns)),
            np.outer(np.sin(up), np.sin(around)),
        ],
        axis=2,
    ).reshape(-1, 3)
    points = np.concatenate([inner, [[0, 1, 0], [0, -1, 0]]])
    k = np.arange(columns)
    after = (k + 1) % columns
    faces = [np.stack([k, np.full(columns, len(inner)), after], axis=1)]
    last = (rows - 2) * columns
    faces.append(np.stack([last + k, last + after, np.full(columns, len(inner) + 1)], axis=1))
    for row in range(rows - 2):
        a, b = row * columns, (row + 1) * columns
        faces.append(np.stack([a + k, a + after, b + k], axis=1))
        faces.append(np.stack([a + after, b + after, b + k], axis=1))
    return points, np.concatenate(faces).astype(np.int32)


def _size(rig: Rig) -> float:
    return float(np.linalg.norm(np.ptp(to_scene(rig, rig.mesh.vertices), axis=0)))
