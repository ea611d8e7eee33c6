"""Multipole moments of triangles, and the local expansion of a distant cluster of them.

The moments A(n), M(n), Q(n) of `clusters.py` are polynomials in a direction n, of first, second
and third degree. A row of SIZE numbers holds their coefficients:

    x, y, z;   xx, yy, zz, xy, xz, yz;   xxx, yyy, zzz, xxy, xxz, xyy, yyz, xzz, yzz, xyz.
"""

from __future__ import annotations

import numpy as np

from ....geometry.vectors import length, triangle_normal
from ....runtime.compiled import compiled

SIZE = 19


@compiled(inline="always")
def linear(p, x, y, z):
    return p[0] * x + p[1] * y + p[2] * z


@compiled(inline="always")
def square(p, x, y, z):
    return x * (p[3] * x + p[6] * y + p[7] * z) + y * (p[4] * y + p[8] * z) + p[5] * z * z


@compiled(inline="always")
def cube(p, x, y, z):
    of_x = p[9] * x * x + p[12] * x * y + p[13] * x * z + p[14] * y * y + p[16] * z * z
    of_y = p[10] * y * y + p[15] * y * z + p[17] * z * z + p[18] * x * z
    return x * of_x + y * of_y + p[11] * z * z * z


@compiled(inline="always")
def _add_square(p, a, b, factor):
    """Add the product of two linear forms."""
    p[3] += factor * a[0] * b[0]
    p[4] += factor * a[1] * b[1]
    p[5] += factor * a[2] * b[2]
    p[6] += factor * (a[0] * b[1] + a[1] * b[0])
    p[7] += factor * (a[0] * b[2] + a[2] * b[0])
    p[8] += factor * (a[1] * b[2] + a[2] * b[1])


@compiled(inline="always")
def _add_cube(p, a, b, factor):
    """Add the product of a linear form and a quadratic one (xx, yy, zz, xy, xz, yz)."""
    p[9] += factor * a[0] * b[0]
    p[10] += factor * a[1] * b[1]
    p[11] += factor * a[2] * b[2]
    p[12] += factor * (a[1] * b[0] + a[0] * b[3])
    p[13] += factor * (a[2] * b[0] + a[0] * b[4])
    p[14] += factor * (a[0] * b[1] + a[1] * b[3])
    p[15] += factor * (a[2] * b[1] + a[1] * b[5])
    p[16] += factor * (a[0] * b[2] + a[2] * b[4])
    p[17] += factor * (a[1] * b[2] + a[2] * b[5])
    p[18] += factor * (a[0] * b[5] + a[1] * b[4] + a[2] * b[3])


@compiled(inline="always")
def _squared(a):
    x, y, z = a
    return x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z


@compiled
def add_triangle(p, a, b, c):
    """Add the moments of a triangle, its corners relative to the centre; return its area."""
    normal = triangle_normal(a, b, c)
    normal = normal[0] / 2, normal[1] / 2, normal[2] / 2
    total = a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]
    p[0] += normal[0]
    p[1] += normal[1]
    p[2] += normal[2]
    _add_square(p, normal, total, 1 / 3)
    # Quadrature of (y . n)^2 over the triangle.
    for corner in (a, b, c, total):
        _add_cube(p, normal, _squared(corner), 1 / 12)
    return length(normal)


@compiled
def add_translated(p, q, shift):
    """Add the moments q of a cluster whose centre is displaced by `shift` from the one of p."""
    p[0] += q[0]
    p[1] += q[1]
    p[2] += q[2]
    _add_square(p, q, shift, 1.0)
    _add_cube(p, q, _squared(shift), 1.0)
    _add_cube(p, shift, q[3:9], 2.0)
    for i in range(3, SIZE):
        p[i] += q[i]


@compiled
def make_harmonic(p):
    """Remove the multiples of |n|^2: 1/|r| is harmonic, so they contribute nothing."""
    mean = (p[3] + p[4] + p[5]) / 3
    for i in range(3, 6):
        p[i] -= mean
    x = (3 * p[9] + p[14] + p[16]) / 5
    y = (3 * p[10] + p[12] + p[17]) / 5
    z = (3 * p[11] + p[13] + p[15]) / 5
    _add_cube(p, (x, y, z), (-1.0, -1.0, -1.0, 0.0, 0.0, 0.0), 1.0)


@compiled(inline="always")
def in_registers(p):
    """Return the moments as a tuple: a loop that writes to arrays must otherwise reload them."""
    # fmt: off
    return (
        p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9],
        p[10], p[11], p[12], p[13], p[14], p[15], p[16], p[17], p[18],
    )
    # fmt: on


@compiled(inline="always")
def add_multipole(local, p, r, distance):
    """Add a cluster's moments to a local expansion; its centre is at r, at that distance."""
    near = 1 / distance
    x, y, z = r[0] * near, r[1] * near, r[2] * near
    scale = near * near / (4 * np.pi)
    ahead, twice = linear(p, x, y, z), square(p, x, y, z)
    local[0] += scale * (ahead + near * (7.5 * near * cube(p, x, y, z) - 3 * twice))
    scale *= near
    along = 3 * ahead - 15 * near * twice
    # The gradient of the quadratic form is twice M n.
    mx = near * (2 * p[3] * x + p[6] * y + p[7] * z)
    my = near * (p[6] * x + 2 * p[4] * y + p[8] * z)
    mz = near * (p[7] * x + p[8] * y + 2 * p[5] * z)
    local[1] += scale * (along * x - p[0] + 3 * mx)
    local[2] += scale * (along * y - p[1] + 3 * my)
    local[3] += scale * (along * z - p[2] + 3 * mz)
    scale *= 3 * near
    local[4] += scale * (ahead * (5 * x * x - 1) - 2 * p[0] * x)
    local[5] += scale * (ahead * (5 * y * y - 1) - 2 * p[1] * y)
    local[6] += scale * (ahead * 5 * x * y - p[0] * y - p[1] * x)
    local[7] += scale * (ahead * 5 * x * z - p[0] * z - p[2] * x)
    local[8] += scale * (ahead * 5 * y * z - p[1] * z - p[2] * y)
