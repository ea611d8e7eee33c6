"""Signed distance fields: primitives, and bodies that are smooth unions of them.

A distance is negative inside. Only +, *, / and square roots are used, which every
processor rounds alike, so that a character comes out the same everywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]
Distance = Callable[[Points], NDArray[np.float64]]


@dataclass(frozen=True)
class Shape:
    """One primitive of a body.

    Parameters
    ----------
    distance : callable
        Points (n, 3) to signed distances (n,).
    centre, radius
        A ball that holds the whole primitive.
    """

    distance: Distance
    centre: Points
    radius: float


def ball(centre: ArrayLike, radius: float) -> Shape:
    """Return a sphere."""
    c = np.asarray(centre, float)
    return Shape(lambda p: _length(p - c) - radius, c, radius)


def ellipsoid(centre: ArrayLike, radii: ArrayLike, axes: ArrayLike | None = None) -> Shape:
    """Return an ellipsoid; `axes` (3, 3) holds its unit axes as rows.

    The distance is a first-order estimate, exact on the surface.
    """
    c, r = np.asarray(centre, float), np.asarray(radii, float)
    frame = np.eye(3) if axes is None else np.asarray(axes, float)

    def distance(p: Points) -> NDArray:
        q = _into(frame, p - c)
        outer, slope = _length(q / r), _length(q / (r * r))
        # At the very centre both are 0 and the quotient would be undefined.
        return np.where(slope > 1e-12, outer * (outer - 1) / np.maximum(slope, 1e-12), -r.min())

    return Shape(distance, c, float(r.max()))


def round_cone(a: ArrayLike, b: ArrayLike, radius_a: float, radius_b: float) -> Shape:
    """Return the convex hull of two balls, at `a` and at `b`."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    axis = b - a
    long = float(np.sqrt((axis * axis).sum()))
    axis = axis / long
    sine = np.clip((radius_a - radius_b) / long, -1.0, 1.0)
    cosine = np.sqrt(1 - sine * sine)

    def distance(p: Points) -> NDArray:
        q = p - a
        y = _dot(q, axis)
        x = np.sqrt(np.maximum(_dot(q, q) - y * y, 0))
        along = y - x * sine / max(cosine, 1e-9)
        near_a = np.sqrt(x * x + y * y) - radius_a
        near_b = np.sqrt(x * x + (y - long) ** 2) - radius_b
        side = x * cosine + y * sine - radius_a
        return np.where(along < 0, near_a, np.where(along > long, near_b, side))

    middle = (a + b) / 2
    return Shape(distance, middle, long / 2 + max(radius_a, radius_b))


def chain(points: ArrayLike, radii: ArrayLike) -> Shape:
    """Return round cones from point to point."""
    points, radii = np.asarray(points, float), np.asarray(radii, float)
    cones = [
        round_cone(a, b, float(ra), float(rb))
        for a, b, ra, rb in zip(points, points[1:], radii, radii[1:], strict=False)
    ]

    return union(cones)


def union(shapes: list[Shape]) -> Shape:
    """Return several shapes as one."""

    def distance(p: Points) -> NDArray:
        nearest = shapes[0].distance(p)
        for shape in shapes[1:]:
            nearest = np.minimum(nearest, shape.distance(p))
        return nearest

    centre = np.mean([shape.centre for shape in shapes], axis=0)
    reach = [float(_length(shape.centre - centre)) + shape.radius for shape in shapes]
    return Shape(distance, centre, max(reach))


def torus(centre: ArrayLike, axis: ArrayLike, ring: float, tube: float) -> Shape:
    """Return a torus around `axis`, of the radii `ring` and `tube`."""
    c, n = np.asarray(centre, float), unit(axis)

    def distance(p: Points) -> NDArray:
        q = p - c
        y = _dot(q, n)
        x = np.sqrt(np.maximum(_dot(q, q) - y * y, 0)) - ring
        return np.sqrt(x * x + y * y) - tube

    return Shape(distance, c, ring + tube)


def rounded_box(
    centre: ArrayLike, half: ArrayLike, radius: float, axes: ArrayLike | None = None
) -> Shape:
    """Return a box of the half sizes `half`, edges rounded by `radius`."""
    c, h = np.asarray(centre, float), np.asarray(half, float) - radius
    frame = np.eye(3) if axes is None else np.asarray(axes, float)

    def distance(p: Points) -> NDArray:
        q = np.abs(_into(frame, p - c)) - h
        return _length(np.maximum(q, 0)) + np.minimum(q.max(axis=1), 0) - radius

    return Shape(distance, c, float(np.sqrt(((h + radius) ** 2).sum())))


def common(a: Shape, b: Shape, blend: float = 0.0) -> Shape:
    """Return what two shapes have in common, its edge softened over `blend`."""
    small = a if a.radius < b.radius else b
    return Shape(
        lambda p: -smooth_min(-a.distance(p), -b.distance(p), blend), small.centre, small.radius
    )


def half_space(point: ArrayLike, outward: ArrayLike) -> Shape:
    """Return all that lies behind a plane; only for `common`, for it has no end."""
    c, n = np.asarray(point, float), unit(outward)
    return Shape(lambda p: _dot(p - c, n), c, 1e9)


def shell(shape: Shape, grow: float) -> Shape:
    """Return the shape grown by a constant thickness."""
    return Shape(lambda p: shape.distance(p) - grow, shape.centre, shape.radius + grow)


def flattened(shape: Shape, point: ArrayLike, normal: ArrayLike, factor: float) -> Shape:
    """Return the shape pressed `factor` times thinner along `normal`, towards `point`."""
    c, n = np.asarray(point, float), unit(normal)

    def distance(p: Points) -> NDArray:
        away = (factor - 1) * _dot(p - c, n)
        return shape.distance(p + away[:, None] * n) / factor

    return Shape(distance, shape.centre, shape.radius)


def mirrored(shape: Shape) -> Shape:
    """Return the shape reflected at the plane x = 0."""
    flip = np.array([-1.0, 1.0, 1.0])
    return Shape(lambda p: shape.distance(p * flip), shape.centre * flip, shape.radius)


def smooth_min(a: NDArray, b: NDArray, blend: float | NDArray) -> NDArray:
    """Return the lesser of two distances, rounded where they differ by less than `blend`."""
    width = np.maximum(blend, 1e-9)
    overlap = np.maximum(width - np.abs(a - b), 0) / width
    return np.minimum(a, b) - overlap * overlap * width / 4


@dataclass(frozen=True)
class Part:
    """A shape in a body.

    Parameters
    ----------
    shape : Shape
    joint : str
        The joint that carries it.
    blend : float
        Over what distance it melts into the parts before it.
    at, reach : optional
        Melt only within `reach` of the point `at` (the joint where the limb is attached);
        elsewhere keep apart, however close.
    edge : float
        Wanted length of mesh edges on it.
    colour : str
    carve : bool
        Take it away instead of adding it.
    """

    shape: Shape
    joint: str
    blend: float = 0.02
    at: Points | None = None
    reach: float = 0.1
    edge: float = 0.02
    colour: str = "skin"
    carve: bool = False


@dataclass
class Body:
    """Parts, one melted into the next, and paint on them."""

    parts: list[Part] = field(default_factory=list)
    paint: list[tuple[Shape, str, float]] = field(default_factory=list)

    def add(self, shape: Shape, joint: str, both: Any = False, **options: Any) -> None:
        """Add a part; with `both`, also its reflection on the right-hand side.

        A joint named "x.L" becomes "x.R" there.
        """
        self.parts.append(Part(shape, joint, **options))
        if both:
            at = options.get("at")
            if at is not None:
                options = {**options, "at": np.asarray(at) * [-1, 1, 1]}
            other = joint.replace(".L", ".R")
            self.parts.append(Part(mirrored(shape), other, **options))

    def colour(self, shape: Shape, colour: str, edge: float, both: bool = False) -> None:
        """Paint all that lies inside the shape, with mesh edges of the length `edge`."""
        self.paint.append((shape, colour, edge))
        if both:
            self.paint.append((mirrored(shape), colour, edge))

    def distance(self, points: Points) -> NDArray:
        """Return the signed distance of points (n, 3); fastest when they lie together."""
        centre = (points.min(axis=0) + points.max(axis=0)) / 2
        spread = float(_length(points - centre).max())
        total = np.full(len(points), 1e6)
        for part in self.parts:
            gap = float(_length(part.shape.centre - centre)) - part.shape.radius - spread
            limit = part.blend - total.min() if part.carve else total.max() + part.blend
            if gap > limit:
                continue  # too far away to change anything here
            total = _joined(part, points, total)
        return total

    def edge_length(self, points: Points, growth: float = 0.3) -> NDArray:
        """Return the wanted length of mesh edges: each part's own near it, growing away."""
        shapes = [(part.shape, part.edge) for part in self.parts]
        shapes += [(shape, edge) for shape, _, edge in self.paint]
        result = np.full(len(points), 1e6)
        for rows in neighbourhoods(points):
            near, lengths = points[rows], result[rows]
            centre = (near.min(axis=0) + near.max(axis=0)) / 2
            spread = float(_length(near - centre).max())
            for shape, edge in shapes:
                gap = float(_length(shape.centre - centre)) - shape.radius - spread
                if edge + growth * max(gap, 0) < lengths.max():
                    distance = np.maximum(shape.distance(near), 0)
                    lengths = np.minimum(lengths, edge + growth * distance)
            result[rows] = lengths
        return result

    def joint_distances(self, points: Points, names: Iterable[str]) -> NDArray:
        """Return the distance of each point to the parts of each joint, shape (n, j)."""
        columns = {name: k for k, name in enumerate(names)}
        distances = np.full((len(points), len(columns)), np.inf)
        for part in self.parts:
            if not part.carve:
                column = distances[:, columns[part.joint]]
                np.minimum(column, part.shape.distance(points), out=column)
        return distances

    def colours(self, points: Points) -> NDArray:
        """Return the name of each point's colour: its nearest part's, or the paint's."""
        solid = [part for part in self.parts if not part.carve]
        nearest = np.argmin([part.shape.distance(points) for part in solid], axis=0)
        names = np.array([part.colour for part in solid], object)[nearest]
        for shape, colour, _ in self.paint:
            names[shape.distance(points) < 0] = colour
        return names


def neighbourhoods(points: Points, cell: float = 0.1) -> list[NDArray]:
    """Return the rows of points in each cell of space: far parts of a body can be skipped."""
    keys = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    code = (keys[:, 0] * 1024 + keys[:, 1]) * 1024 + keys[:, 2]
    order = np.argsort(code, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(code[order])) + 1)


def shifted(point: ArrayLike, x: float, y: float, z: float) -> NDArray:
    """Return a point moved by x, y, z."""
    return np.asarray(point, float) + np.array([x, y, z])


def unit(vector: ArrayLike) -> NDArray:
    """Return the vector at length 1."""
    vector = np.asarray(vector, float)
    return vector / np.sqrt((vector * vector).sum())


def _joined(part: Part, points: Points, total: NDArray) -> NDArray:
    distance = part.shape.distance(points)
    blend: float | NDArray = part.blend
    if part.at is not None:
        t = np.clip(1 - _length(points - part.at) / part.reach, 0, 1)
        blend = part.blend * np.minimum(t * 2, 1) ** 2 * (3 - 2 * np.minimum(t * 2, 1))
    if part.carve:
        return -smooth_min(-total, distance, blend)
    return smooth_min(total, distance, blend)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    product = a * b
    return product[..., 0] + product[..., 1] + product[..., 2]


def _length(vectors: NDArray) -> NDArray:
    return np.sqrt(_dot(vectors, vectors))


def _into(frame: NDArray, vectors: Points) -> Points:
    return np.stack([_dot(vectors, axis) for axis in frame], axis=-1)
