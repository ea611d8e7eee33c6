"""Winding number (solid angle over 4 pi) of the caps at several points, within a proven bound.

The points traverse the tree of clusters together, and each cluster is evaluated for all of them by
vector instructions. So the loops over points have no branches.
"""

from __future__ import annotations

import numpy as np

from ....geometry.vectors import between, length
from ....runtime.compiled import no_refcount, vectorized
from .clusters import error_bound, next_cluster
from .multipole import cube, in_registers, linear, square

POINTS_TOGETHER = 264
"""Points at most. A constant, so that the compiler knows that rows do not overlap; no power of two,
so that rows do not compete for one set of the cache."""
Y, Z, VALUE, RE, IM, CLEAR, WORKSPACE = (POINTS_TOGETHER * row for row in range(1, 8))
"""Offsets of the rows of a workspace, after the points' x; the last one is its size. VALUE: winding
numbers. RE, IM: complex numbers whose arguments are the angles. CLEAR: positive for points far
enough from all caps for rounding not to matter."""
SIMD_WIDTH = 8
"""The number of points is rounded up to a multiple of this."""
RESCALE_EVERY = 8
"""Triangles. One multiplies the complex numbers by 1e-35 (a corner 1e-15 away) to 20."""
ON_CAP = 1e-7
"""Closer to a cap than this, relative to its size, rounding may put a point on either side."""
NO_LENGTH = 1e-300


@no_refcount
def caps_winding_numbers(clusters, among, centre, reach, tolerance, points, count):
    """Sum the winding numbers of caps at some points.

    Shapes: points (WORKSPACE,).
    """
    error, leaves, unscaled = 0.0, len(clusters.start) - 1, np.int64(0)
    for i in range(count):
        points[VALUE + i] = points[IM + i] = 0.0
        points[RE + i] = points[CLEAR + i] = 1.0
    for top in among:
        k = np.int64(top)
        end = next_cluster(k)
        while k != end:
            distance = length(between(centre, clusters.sphere[k])) - reach
            own_error = error_bound(clusters.sphere[k], distance, 0.0)
            if own_error <= tolerance:
                _add_cluster(clusters.moments[k], clusters.sphere[k], points, count)
                error += own_error
            elif k < leaves:
                k *= 2
                continue
            else:
                for loop in range(clusters.start[k - leaves], clusters.start[k - leaves + 1]):
                    rim = clusters.rim[clusters.first[loop] : clusters.first[loop + 1]]
                    unscaled = _add_cap(rim, clusters.apex[loop], points, count, unscaled)
            k = next_cluster(k)
    for i in range(count):
        points[VALUE + i] += np.arctan2(points[IM + i], points[RE + i]) / (2 * np.pi)
    return error


@vectorized
def _add_cluster(moments, sphere, points, count):
    """Add the multipole expansion of a cluster: the value of `multipole.add_multipole`."""
    p = in_registers(moments)
    cx, cy, cz = sphere[0], sphere[1], sphere[2]
    for i in range(count):
        x, y, z = cx - points[i], cy - points[Y + i], cz - points[Z + i]
        near = 1 / np.sqrt(x * x + y * y + z * z)
        x, y, z = x * near, y * near, z * near
        rest = 7.5 * near * cube(p, x, y, z) - 3 * square(p, x, y, z)
        points[VALUE + i] += (linear(p, x, y, z) + near * rest) * near * near / (4 * np.pi)


@no_refcount
def _add_cap(rim, apex, points, count, unscaled):
    """Add the solid angles of one cap.

    Half the solid angle of a triangle is the argument of a complex number (van Oosterom &
    Strackee 1983). The arguments are added by multiplying the numbers; full turns are counted
    separately: the sum of two arguments in one half plane has wrapped around if the product is in
    the other. `unscaled` triangles were added since the last rescaling; returns how many it is now.
    """
    # Where the apex is the rim's first vertex, the edges at it span no triangle.
    begin, end = (2, len(rim)) if len(rim) <= 4 else (1, len(rim) + 1)
    for e in range(begin, end):
        _add_triangle(apex, rim[e - 1], rim[e if e < len(rim) else 0], points, count)
        unscaled += 1
        if unscaled == RESCALE_EVERY:
            _rescale(points, count)
            unscaled = 0
    return unscaled


@vectorized
def _rescale(points, count):
    """Rescale the complex numbers before further products under- or overflow."""
    for i in range(count):
        scale = 1 / (abs(points[RE + i]) + abs(points[IM + i]) + NO_LENGTH)
        points[RE + i] *= scale
        points[IM + i] *= scale


@vectorized
def _add_triangle(p, q, r, points, count):
    """Add the solid angle of a triangle p q r."""
    px, py, pz = p[0], p[1], p[2]
    qx, qy, qz = q[0], q[1], q[2]
    rx, ry, rz = r[0], r[1], r[2]
    for i in range(count):
        x, y, z = points[i], points[Y + i], points[Z + i]
        cx, cy, cz = px - x, py - y, pz - z
        bx, by, bz = qx - x, qy - y, qz - z
        ax, ay, az = rx - x, ry - y, rz - z
        lc = np.sqrt(cx * cx + cy * cy + cz * cz)
        lb = np.sqrt(bx * bx + by * by + bz * bz)
        la = np.sqrt(ax * ax + ay * ay + az * az)
        triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        rest = la * lb * lc + (ax * bx + ay * by + az * bz) * lc
        rest += (bx * cx + by * cy + bz * cz) * la + (cx * ax + cy * ay + cz * az) * lb
        was, re = points[IM + i], points[RE + i]
        im = re * triple + was * rest
        re = re * rest - was * triple
        # Full turns, counted without a branch.
        up = (was >= 0) & (triple >= 0) & (im < 0)
        down = (was < 0) & (triple < 0) & (im >= 0)
        points[VALUE + i] += np.float64(up) - np.float64(down)
        points[RE + i], points[IM + i] = re, im
        clear = abs(triple) + max(rest, 0.0) - ON_CAP * la * lb * lc
        points[CLEAR + i] = min(points[CLEAR + i], clear)
