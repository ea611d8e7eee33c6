"""Distances and fields of triangles and edges, all given as seen from the point."""

from __future__ import annotations

import numpy as np

from ..compiled import compiled


@compiled(inline="always")
def turning(a, b, la, lb):
    """Return what an edge a -> b of a loop adds to the gradient of the solid angle over 4 pi.

    Biot and Savart's law: it is the field of a current around the loop, the integral of
    r x dr / (4 pi |r|^3). la and lb are the lengths of a and b.
    """
    n = cross(a, b)
    below = la * lb * (la * lb + dot(a, b))
    factor = (la + lb) / (4 * np.pi * below) if below > 0 else 0.0
    return n[0] * factor, n[1] * factor, n[2] * factor


@compiled(inline="always")
def distance_to_edge(a, b):
    """Return how far the point is from the edge between a and b."""
    e = between(a, b)
    squared = dot(e, e)
    t = min(max(-dot(a, e) / squared, 0.0), 1.0) if squared > 0 else 0.0
    return length((a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]))


@compiled
def is_within(a, b, c, reach):
    """Tell whether a triangle comes within reach of the point, its edge a, b left out."""
    n = cross(between(a, b), between(a, c))
    height = dot(a, n)
    if height * height > reach * reach * dot(n, n):
        return False
    # Within reach of the plane: its foot lies inside if it is on one side of all edges.
    if dot(n, cross(a, b)) > 0 and dot(n, cross(b, c)) > 0 and dot(n, cross(c, a)) > 0:
        return True
    return min(distance_to_edge(a, c), distance_to_edge(b, c)) <= reach


@compiled(inline="always")
def between(a, b):
    """Return the way from a to b."""
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


@compiled(inline="always")
def dot(a, b):
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled(inline="always")
def cross(a, b):
    """Return the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled(inline="always")
def length(a):
    """Return the Euclidean length."""
    return np.sqrt(dot(a, a))
