"""Closed meshes of machine parts: rounded boxes and turned solids."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .sdf import unit


@dataclass(frozen=True)
class Plate:
    """A closed mesh: vertices (n, 3), faces (m, 3) counter-clockwise from outside."""

    vertices: NDArray
    faces: NDArray

    def moved(self, offset: ArrayLike) -> Plate:
        """Return it elsewhere."""
        return Plate(self.vertices + np.asarray(offset, float), self.faces)

    def turned(self, axes: ArrayLike) -> Plate:
        """Return it turned: `axes` (3, 3) holds where its x, y and z point, as rows."""
        x, y, z = (self.vertices[:, k, None] for k in range(3))
        a = np.asarray(axes, float)
        return Plate(x * a[0] + y * a[1] + z * a[2], self.faces)

    def along(self, start: ArrayLike, end: ArrayLike, at: float = 0.5) -> Plate:
        """Return it with its y axis along a line and its origin on it."""
        start, end = np.asarray(start, float), np.asarray(end, float)
        y = unit(end - start)
        x = unit(np.cross(y, [0, 0, 1]))
        return self.turned([x, y, np.cross(x, y)]).moved(start + at * (end - start))

    def mirrored(self) -> Plate:
        """Return its reflection at x = 0."""
        return Plate(self.vertices * [-1, 1, 1], self.faces[:, ::-1])

    def normals(self) -> NDArray:
        """Return a unit normal for each vertex, larger faces counting more."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        weighted = np.repeat(np.cross(b - a, c - a), 3, axis=0)
        count = len(self.vertices)
        total = [np.bincount(self.faces.ravel(), w, count) for w in weighted.T]
        normals = np.stack(total, axis=1)
        return normals / np.sqrt((normals**2).sum(axis=1, keepdims=True))


def box(half: ArrayLike, radius: float, longest: float = 0.085) -> Plate:
    """Return a box of half sizes `half`, edges and corners rounded, edges up to `longest`."""
    half = np.asarray(half, float)
    lines = [_ticks(h, radius, longest) for h in half]
    sheets, faces, count = [], [], 0
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1, 1):
            grid = np.empty((len(lines[u]), len(lines[v]), 3))
            grid[..., axis] = sign * half[axis]
            grid[..., u], grid[..., v] = np.meshgrid(lines[u], lines[v], indexing="ij")
            quads = _quads(len(lines[u]), len(lines[v])) + count
            faces.append(quads if sign > 0 else quads[:, ::-1])
            sheets.append(grid.reshape(-1, 3))
            count += len(sheets[-1])
    points = np.concatenate(sheets)
    inner = np.clip(points, radius - half, half - radius)
    out = points - inner
    points = inner + radius * out / np.sqrt((out**2).sum(axis=1, keepdims=True))
    return _welded(points, np.concatenate(faces))


def turned(
    profile: ArrayLike, bevel: float = 0.012, sides: int = 20, longest: float = 0.08
) -> Plate:
    """Return the solid that a profile (k, 2) of (radius, y) sweeps around the y axis.

    The profile runs upwards, outside to its right. It either starts and ends on the axis,
    or it is a closed loop that stays clear of it. Its corners are rounded.
    """
    points = np.asarray(profile, float)
    loop = points[0, 0] > 0
    line = _divided(_rounded(points, bevel, loop), longest, loop)
    angle = 2 * np.pi * np.arange(sides) / sides
    circle = np.round(np.column_stack([np.sin(angle), np.cos(angle)]), 9)
    rings = np.empty((len(line), sides, 3))
    rings[..., 0] = line[:, :1] * circle[:, 0]
    rings[..., 1] = line[:, 1:]
    rings[..., 2] = line[:, :1] * circle[:, 1]
    rows = np.arange(len(line) * sides).reshape(len(line), sides)
    rows = np.concatenate([rows, rows[:, :1]], axis=1)
    if loop:
        rows = np.concatenate([rows, rows[:1]], axis=0)
    a, b = rows[:-1, :-1].ravel(), rows[:-1, 1:].ravel()
    c, d = rows[1:, 1:].ravel(), rows[1:, :-1].ravel()
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return _welded(rings.reshape(-1, 3), faces)


def barrel(low: float, high: float, length: float, bevel: float = 0.012, sides: int = 20) -> Plate:
    """Return a round bar along y around the origin: radius at its low and its high end."""
    h = length / 2
    return turned([[0, -h], [low, -h], [high, h], [0, h]], bevel, sides)


def globe(radius: float, low: float = -1.0, high: float = 1.0, sides: int = 20) -> Plate:
    """Return a ball, or the slice of it between two heights given as parts of its radius."""
    angle = np.linspace(np.arcsin(low), np.arcsin(high), 3 + round(8 * (high - low)))
    arc = radius * np.round(np.column_stack([np.cos(angle), np.sin(angle)]), 9)
    flat = [arc]
    if low > -1:
        flat.insert(0, np.array([[0, radius * low]]))
    if high < 1:
        flat.append(np.array([[0, radius * high]]))
    points = np.concatenate(flat)
    points[[0, -1], 0] = 0
    return turned(points, 0.0 if low <= -1 and high >= 1 else 0.01, sides)


def _ticks(half: float, radius: float, longest: float) -> NDArray:
    """Return where grid lines cross an edge: two steps in each half rounding, equal between."""
    flat = np.linspace(
        radius - half, half - radius, 1 + int(np.ceil(2 * (half - radius) / longest))
    )
    # Once pushed onto the rounding, these are 45 and 22.5 degrees from the flat.
    bend = radius * np.array([1.0, 0.414213562])
    return np.concatenate([-(half - radius) - bend, flat, (half - radius) + bend[::-1]])


def _quads(rows: int, columns: int) -> NDArray:
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].ravel(), index[1:, :-1].ravel()
    c, d = index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _rounded(points: NDArray, bevel: float, loop: bool) -> NDArray:
    """Replace each corner by a short curve that starts `bevel` before it."""
    if bevel <= 0:
        return points
    result = []
    for k, corner in enumerate(points):
        if not loop and k in (0, len(points) - 1):
            result.append(corner[None])
            continue
        before, after = points[k - 1], points[(k + 1) % len(points)]
        ends = []
        for other in (before, after):
            reach = np.sqrt(((other - corner) ** 2).sum())
            ends.append(corner + (other - corner) * min(bevel / reach, 0.4))
        u = np.linspace(0, 1, 3)[:, None]
        result.append((1 - u) ** 2 * ends[0] + 2 * u * (1 - u) * corner + u * u * ends[1])
    return np.concatenate(result)


def _divided(points: NDArray, longest: float, loop: bool) -> NDArray:
    ends = np.concatenate([points, points[:1]]) if loop else points
    pieces = []
    for a, b in pairwise(ends):
        count = max(1, int(np.ceil(np.sqrt(((b - a) ** 2).sum()) / longest - 1e-9)))
        pieces.append(a + np.arange(count)[:, None] / count * (b - a))
    return np.concatenate(pieces if loop else [*pieces, ends[-1:]])


def _welded(points: NDArray, faces: NDArray) -> Plate:
    """Join equal points and drop the triangles that lose their area by it."""
    points = np.round(points, 7) + 0.0  # and no negative zeros
    points, index = np.unique(points, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    return Plate(points, faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)])
