"""Vectors as tuples of three floats, for kernels."""

from __future__ import annotations

import numpy as np

from ..runtime.compiled import inlined

TIE = 1e-9
"""Lengths in the unit cube that differ by no more are equal, and so are parts of a whole: rounding,
which is far smaller, must not choose among them. The smallest lattice cell is a million times as
large."""


@inlined
def between(a, b):
    """Return the displacement from a to b."""
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


@inlined
def dot(a, b):
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a, b):
    """Return the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def length(a):
    """Return the Euclidean length."""
    return np.sqrt(dot(a, a))


@inlined
def triangle_normal(a, b, c):
    """Return the normal of a triangle, as long as twice its area."""
    return cross(between(a, b), between(a, c))


@inlined
def segment_fraction(a, b, point):
    """Return where the segment from a, 0, to b, 1, is closest to a point."""
    along = between(a, b)
    squared = dot(along, along)
    return min(max(dot(between(a, point), along) / squared, 0.0), 1.0) if squared > 0 else 0.0
