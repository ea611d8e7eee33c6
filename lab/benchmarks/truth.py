"""Shapes whose distances through the inside are known.

Ball and box are convex: straight lines. In the L-shaped bar the shortest path bends at the
reflex edge, by how much tells its unfolding. In a torus and in a spiral tube there is no
closed form, but a convex problem: seen in the cross-sections of a tube, in order, a path
is one point in each disc, its length is a convex function of all their coordinates and
the discs are convex. `shortest_through_discs` solves it; the error of its polyline is
about h^2 / 24 for sections that turn by h (about 1e-4 here).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import trimesh
from numba import njit, prange

from cutcell import TriangleMesh

SECTIONS = 48
STEPS = 2000
TARGETS = 200
"""Vertices of tubes whose true distances are computed, drawn at random."""


@dataclass(frozen=True)
class Shape:
    """A mesh, points in it, and the distances (s, t) from them to some of its vertices."""

    name: str
    mesh: TriangleMesh
    sources: np.ndarray
    targets: np.ndarray
    distance: np.ndarray


def ball(fineness: int = 4) -> Shape:
    """Make a ball: every two points see each other."""
    mesh = trimesh.creation.icosphere(subdivisions=fineness, radius=0.5)
    sources = np.array([[0.02, 0.01, 0.03], [0.2, -0.15, 0.1], [-0.3, 0.05, -0.2], [0, 0.35, 0.1]])
    return _straight("ball", mesh.vertices, mesh.faces, sources)


def box(fineness: int = 4) -> Shape:
    """Make a box: every two points see each other."""
    mesh = trimesh.creation.box(extents=(1, 0.5, 0.3))
    vertices, faces = _refined(mesh.vertices, mesh.faces, fineness)
    sources = np.array([[0.01, 0.02, 0.03], [0.3, -0.1, 0.05], [-0.4, 0.15, -0.1], [-0.2, 0, 0.1]])
    return _straight("box", vertices, faces, sources)


def _straight(name, vertices, faces, sources) -> Shape:
    vertices = np.array(vertices)
    distance = np.linalg.norm(vertices - sources[:, None], axis=2)
    return Shape(name, TriangleMesh(vertices, faces), sources, np.arange(len(vertices)), distance)


def l_bar(fineness: int = 4) -> Shape:
    """Make an L-shaped bar: paths straighten around its reflex edge."""
    outline = [(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)]
    corners = [(x, y, z) for z in (0, 0.25) for x, y in outline]
    lid = np.array([(0, k, k + 1) for k in range(1, 5)])  # all of the L is seen from its corner
    k = np.arange(6)
    after = (k + 1) % 6
    sides = np.concatenate([np.stack([k, after, k + 6], 1), np.stack([after, after + 6, k + 6], 1)])
    faces = np.concatenate([lid[:, ::-1], lid + 6, sides])
    vertices, faces = _refined(np.array(corners), faces, fineness)
    sources = np.array([[0.9, 0.1, 0.1], [0.11, 0.12, 0.12], [0.6, 0.2, 0.05], [0.2, 0.8, 0.15]])
    distance = np.stack([around_edge(source, vertices) for source in sources])
    return Shape(
        "L-bar", TriangleMesh(vertices, faces), sources, np.arange(len(vertices)), distance
    )


def around_edge(source: np.ndarray, points: np.ndarray, corner: float = 0.3) -> np.ndarray:
    """Measure paths in the L-bar, whose reflex edge is the line x = y = corner.

    Where the segment would cut the corner, unfold the path about the edge: its two legs
    become one straight line, over radius + radius in the plane and the same climb.
    """
    from_edge, to_edge = (p[..., :2] - corner for p in (source, points))
    begin, end = (_angle_inside(v) for v in (from_edge, to_edge))
    radius = np.linalg.norm(from_edge), np.linalg.norm(to_edge, axis=1)
    hidden = np.abs(end - begin) > np.pi
    climb = points[:, 2] - source[2]
    bent = np.hypot(radius[0] + radius[1], climb)
    return np.where(hidden, bent, np.linalg.norm(points - source, axis=1))


def _angle_inside(away: np.ndarray) -> np.ndarray:
    """Return angles about the edge, through the inside of the L: 0 at a wall to 3/2 pi."""
    angle = np.mod(np.arctan2(away[..., 1], away[..., 0]) - np.pi / 2, 2 * np.pi)
    return np.where(angle > 1.75 * np.pi, 0.0, angle)  # rounding may step behind the first wall


def _refined(vertices, faces, times: int):
    """Quarter all triangles a number of times."""
    for _ in range(times):
        vertices, faces = trimesh.remesh.subdivide(vertices, faces)
    return np.array(vertices), np.array(faces)


@dataclass(frozen=True)
class Tube:
    """Discs of one radius around a centre line: centre(t), and their axes normal(t), up.

    Parameters
    ----------
    frame : callable
        From parameters (k,) to centres (k, 3) and unit normals (k, 3) in the disc; the
        other axis of each disc is z.
    """

    frame: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    radius: float

    def points(self, t: np.ndarray, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Place disc coordinates (x, z) at the parameters t."""
        centre, normal = self.frame(t)
        return centre + x[..., None] * normal + z[..., None] * np.array([0.0, 0.0, 1.0])

    def mesh(self, begin: float, end: float, along: int, around: int, closed: bool):
        """Mesh the tube; returns vertices, faces, and the parameter of each vertex and (x, z)."""
        t = np.linspace(begin, end, along, endpoint=not closed)
        angle = np.arange(around) * 2 * np.pi / around
        x, z = self.radius * np.cos(angle), self.radius * np.sin(angle)
        grid = np.repeat(t, around)
        place = np.stack([np.tile(x, along), np.tile(z, along)], axis=1)
        vertices = self.points(grid, *place.T)
        i = np.arange(along if closed else along - 1)[:, None] * around
        j = np.arange(around)[None]
        a, b = i + j, i + (j + 1) % around
        c, d = (a + around) % len(grid), (b + around) % len(grid)
        sides = [np.stack([p.ravel() for p in q], 1) for q in ((a, c, b), (b, c, d))]
        if not closed:
            fan = np.stack([np.zeros(around - 2, int), np.arange(1, around - 1)], 1)
            fan = np.column_stack([fan, fan[:, 1] + 1])
            sides += [fan, fan[:, ::-1] + len(grid) - around]
        faces = np.concatenate(sides)
        corners = vertices[faces]
        if np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) < 0:
            faces = faces[:, ::-1]
        return vertices, faces, grid, place


def shortest_through_discs(
    tube: Tube, begin: np.ndarray, end: np.ndarray, sections: int = SECTIONS, steps: int = STEPS
) -> np.ndarray:
    """Measure shortest paths in a tube between points given as (t, x, z), shape (p, 3).

    Projected gradient descent with momentum (FISTA) on the points where each path meets
    the sections between its ends.
    """
    share = np.linspace(0, 1, sections + 1)
    t = begin[:, 0, None] + share * (end[:, 0] - begin[:, 0])[:, None]
    centre, normal = tube.frame(t)
    place = begin[:, None, 1:] + share[:, None] * (end[:, 1:] - begin[:, 1:])[:, None]
    length = np.empty(len(begin))
    _straighten(centre, normal, place, tube.radius, steps, length)
    return length


@njit(cache=True, parallel=True)
def _straighten(centre, normal, place, radius, steps, length):
    for p in prange(len(place)):
        now, ahead = place[p], place[p].copy()
        pull = np.zeros((len(now) - 1, 3))
        momentum = 1.0
        for _ in range(steps):
            # A point is pulled by the directions of the two pieces that it joins, and gives
            # way the more, the longer they are.
            pace = _pieces(centre[p], normal[p], ahead, pull)[0] / 4
            last, momentum = momentum, (1 + np.sqrt(1 + 4 * momentum**2)) / 2
            carry = (last - 1) / momentum
            for k in range(1, len(now) - 1):
                force_x = 0.0
                for d in range(3):
                    force_x += (pull[k, d] - pull[k - 1, d]) * normal[p, k, d]
                x = ahead[k, 0] + pace * force_x
                z = ahead[k, 1] + pace * (pull[k, 2] - pull[k - 1, 2])
                inward = min(radius / max(np.sqrt(x * x + z * z), 1e-300), 1.0)
                x, z = x * inward, z * inward
                ahead[k, 0] = x + carry * (x - now[k, 0])
                ahead[k, 1] = z + carry * (z - now[k, 1])
                now[k, 0], now[k, 1] = x, z
        length[p] = _pieces(centre[p], normal[p], now, pull)[1]


@njit(cache=True)
def _pieces(centre, normal, place, direction):
    """Store the directions of a path's pieces; return the shortest and the whole length."""
    shortest, whole = np.inf, 0.0
    for k in range(len(direction)):
        squared = 0.0
        for d in range(3):
            end = centre[k + 1, d] + place[k + 1, 0] * normal[k + 1, d]
            start = centre[k, d] + place[k, 0] * normal[k, d]
            if d == 2:
                end, start = end + place[k + 1, 1], start + place[k, 1]
            direction[k, d] = end - start
            squared += direction[k, d] ** 2
        size = max(np.sqrt(squared), 1e-12)
        for d in range(3):
            direction[k, d] /= size
        shortest, whole = min(shortest, size), whole + size
    return shortest, whole


def torus(along: int = 192, around: int = 48) -> Shape:
    """Make a torus: paths lead around the hole on the shorter side."""
    tube = Tube(_circle, 0.14)
    vertices, faces, t, place = tube.mesh(0, 2 * np.pi, along, around, closed=True)
    sources = np.array([[0.02, 0.01, 0.02], [1.0, -0.05, 0.06]])
    targets = _sample(len(vertices))
    ends = np.column_stack([t, place])[targets]
    distance = []
    for source in sources:
        turn = np.mod(ends[:, 0] - source[0], 2 * np.pi)
        begin = np.broadcast_to(source, ends.shape)
        ways = [
            shortest_through_discs(tube, begin, np.column_stack([source[0] + way, ends[:, 1:]]))
            for way in (turn, turn - 2 * np.pi)
        ]
        distance.append(np.minimum(*ways))
    points = tube.points(*sources.T)
    return Shape("torus", TriangleMesh(vertices, faces), points, targets, np.stack(distance))


def _circle(t):
    cos, sin, zero = np.cos(t), np.sin(t), np.zeros_like(t)
    normal = np.stack([cos, sin, zero], axis=-1)
    return 0.35 * normal, normal


def spiral(along: int = 480, around: int = 24) -> Shape:
    """Make a thin tube along a spiral of two and a half turns: walls everywhere."""
    tube = Tube(_spiral, 0.035)
    vertices, faces, t, place = tube.mesh(SPIRAL[0], SPIRAL[1], along, around, closed=False)
    source = np.array([SPIRAL[0] + 0.05, 0.005, 0.003])
    targets = _sample(len(vertices))
    targets = targets[t[targets] > source[0] + 0.02]
    ends = np.column_stack([t, place])[targets]
    # Pieces of a long path that turn as little as those of the torus.
    sections = 5 * SECTIONS
    distance = shortest_through_discs(
        tube, np.broadcast_to(source, ends.shape), ends, sections, 2 * STEPS
    )
    points = tube.points(*source[:, None])
    return Shape("spiral tube", TriangleMesh(vertices, faces), points, targets, distance[None])


SPIRAL = (np.pi, 6 * np.pi)
PITCH = 0.15 / (2 * np.pi)


def _spiral(t):
    cos, sin, zero = np.cos(t), np.sin(t), np.zeros_like(t)
    radius = PITCH * t
    centre = radius[..., None] * np.stack([cos, sin, zero], axis=-1)
    forward = np.stack([PITCH * cos - radius * sin, PITCH * sin + radius * cos, zero], axis=-1)
    forward /= np.linalg.norm(forward, axis=-1, keepdims=True)
    normal = np.stack([forward[..., 1], -forward[..., 0], zero], axis=-1)
    return centre, normal


def _sample(count: int) -> np.ndarray:
    chosen = np.random.default_rng(0).choice(count, min(TARGETS, count), replace=False)
    return np.sort(chosen)


SHAPES = {"ball": ball, "box": box, "L-bar": l_bar, "torus": torus, "spiral tube": spiral}
