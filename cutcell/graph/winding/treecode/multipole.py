"""Multipole moments of triangles, and the local expansion of a distant cluster of them.

The moments A(n), M(n), Q(n) of `clusters.py` are polynomials in a direction n, of first, second
and third degree. A row of MOMENTS_SIZE numbers holds their coefficients:

    x, y, z;   xx, yy, zz, xy, xz, yz;   xxx, yyy, zzz, xxy, xxz, xyy, yyz, xzz, yzz, xyz.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....geometry.triangles import normals
from ....runtime.compiled import compiled, inlined

MOMENTS_SIZE = 19
MONOMIALS = (
    *((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)),
    *((0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 0, 1), (0, 0, 2), (0, 1, 1), (1, 1, 2), (0, 2, 2)),
    *((1, 2, 2), (0, 1, 2)),
)
"""The axes of the products in a row, after x, y and z."""
SECOND, THIRD = (
    np.array(
        [[m == tuple(sorted(axes)) for m in same] for axes in np.ndindex((3,) * degree)], float
    )
    for degree, same in ((2, MONOMIALS[:6]), (3, MONOMIALS[6:]))
)
"""Which products of a tensor are added up, shapes (9, 6) and (27, 10)."""


@inlined
def linear(p, x, y, z):
    return p[0] * x + p[1] * y + p[2] * z


@inlined
def square(p, x, y, z):
    return x * (p[3] * x + p[6] * y + p[7] * z) + y * (p[4] * y + p[8] * z) + p[5] * z * z


@inlined
def cube(p, x, y, z):
    of_x = p[9] * x * x + p[12] * x * y + p[13] * x * z + p[14] * y * y + p[16] * z * z
    of_y = p[10] * y * y + p[15] * y * z + p[17] * z * z + p[18] * x * z
    return x * of_x + y * of_y + p[11] * z * z * z


def moments_of(
    corners: NDArray[np.float64], leaf: NDArray[np.int64], centre: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute the moments of the clusters of a balanced binary tree.

    Shapes: corners (t, 3, 3), triangles leaf by leaf; leaf (m,), the first triangle of each;
    centre (2 m, 3); returns (2 m, MOMENTS_SIZE).
    """
    leaves, count = len(leaf), len(centre)
    n, ny, nyy = (np.zeros((count, *shape)) for shape in ((3,), (3, 3), (3, 3, 3)))
    if len(corners) == 0:
        return np.zeros((count, MOMENTS_SIZE))
    normal = normals(corners)
    y = corners - np.repeat(centre[leaves:], np.diff(leaf, append=len(corners)), axis=0)[:, None]
    y = np.concatenate([y, y.sum(axis=1, keepdims=True)], axis=1)  # with three times the middle
    squares = np.einsum("tca,tcb->tab", y, y)  # quadrature
    n[leaves:] = np.add.reduceat(normal / 2, leaf)
    ny[leaves:] = np.add.reduceat(normal[:, :, None] * y[:, None, 3] / 6, leaf)
    nyy[leaves:] = np.add.reduceat(normal[:, :, None, None] * squares[:, None] / 24, leaf)
    level = leaves // 2
    while level:
        child = np.arange(2 * level, 4 * level)
        shift = centre[child] - centre[child // 2]
        n_shift = n[child, :, None] * shift[:, None]
        ny_shift = ny[child, ..., None] * shift[:, None, None]
        n_squared = n_shift[..., None] * shift[:, None, None]
        moved = (
            n[child],
            ny[child] + n_shift,
            nyy[child] + ny_shift + ny_shift.swapaxes(2, 3) + n_squared,
        )
        for sums, halves in zip((n, ny, nyy), moved, strict=True):
            sums[level : 2 * level] = halves[::2] + halves[1::2]
        level //= 2
    rows = n, ny.reshape(count, 9) @ SECOND, nyy.reshape(count, 27) @ THIRD
    return _harmonic(np.concatenate(rows, axis=1))


def _harmonic(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Remove the multiples of |n|^2 from rows: 1/|r| is harmonic, so they contribute nothing."""
    p[:, 3:6] -= p[:, 3:6].mean(axis=1, keepdims=True)
    for cubic, *others in ((9, 14, 16), (10, 12, 17), (11, 13, 15)):
        excess = (3 * p[:, cubic] + p[:, others].sum(axis=1)) / 5
        p[:, [cubic, *others]] -= excess[:, None]
    return p


@compiled(inline="always")
def in_registers(p):
    """Return the moments as a tuple: a loop that writes to arrays must otherwise reload them."""
    # fmt: off
    return (
        p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9],
        p[10], p[11], p[12], p[13], p[14], p[15], p[16], p[17], p[18],
    )
    # fmt: on


@inlined
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
