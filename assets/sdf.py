"""Signed distance fields: primitives and what can be made of two.

A distance is negative inside. Only +, *, / and square roots are used, which every
processor rounds alike, so that a character comes out the same everywhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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
    return Shape(lambda p: length(p - c) - radius, c, radius)


def ellipsoid(centre: ArrayLike, radii: ArrayLike, axes: ArrayLike | None = None) -> Shape:
    """Return an ellipsoid; `axes` (3, 3) holds its unit axes as rows.

    The distance is a first-order estimate, exact on the surface.
    """
    c, r = np.asarray(centre, float), np.asarray(radii, float)
    frame = np.eye(3) if axes is None else np.asarray(axes, float)

    def distance(p: Points) -> NDArray:
        q = _into(frame, p - c)
        outer, slope = length(q / r), length(q / (r * r))
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
    reach = [float(length(shape.centre - centre)) + shape.radius for shape in shapes]
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


def shifted(point: ArrayLike, x: float, y: float, z: float) -> NDArray:
    """Return a point moved by x, y, z."""
    return np.asarray(point, float) + np.array([x, y, z])


def unit(vector: ArrayLike) -> NDArray:
    """Return the vector at length 1."""
    vector = np.asarray(vector, float)
    return vector / np.sqrt((vector * vector).sum())


def _dot(a: NDArray, b: NDArray) -> NDArray:
    product = a * b
    return product[..., 0] + product[..., 1] + product[..., 2]


def length(vectors: NDArray) -> NDArray:
    """Return the length of each vector."""
    return np.sqrt(_dot(vectors, vectors))


def _into(frame: NDArray, vectors: Points) -> Points:
    return np.stack([_dot(vectors, axis) for axis in frame], axis=-1)
