"""What caps cover of the view from several points, within a proven bound.

All points go through the tree of clusters together. What a cluster covers is worked out for all of
them side by side, in the lanes of vector instructions; so the loops have no branches.
"""

from __future__ import annotations

import numpy as np

from ..compiled import lean, side_by_side
from .clusters import left_out
from .moments import cube, held, linear, square
from .solid_angle import between, length
from .view import after

WIDTH = 264
"""Points at most. Fixed, so that no loop has to look whether its rows overlap; and no power of
two, so that rows do not share one place of the cache."""
Y, Z, VALUE, RE, IM, CLEAR, ROOM = (WIDTH * row for row in range(1, 8))
"""Where rows begin of an array of so much room: after the points' x, their y and z; what is
covered; the real and the imaginary part of angles; above zero what is clear of rounding."""
LANES = 8
"""Points filled up to a multiple of this leave none over for a loop of its own."""
SPARED = 8
"""Triangles after which angles, products of complex numbers, are scaled. One multiplies them by
something between 1e-35 (a corner is 1e-15 away) and 20."""
NEAR = 1e-7
"""Nearer to a cap than this, relative to its size, rounding may put a point on either side."""
TINY = 1e-300


@lean
def cover(clusters, among, centre, reach, tolerance, seen, lanes):
    """Put what caps cover of the view from some points beside them.

    Parameters
    ----------
    clusters : Clusters
    among : array, int32
        The clusters of these caps.
    centre, reach
        Of a ball that holds all points.
    tolerance : float
        Clusters that may leave out more than this are halved.
    seen : array, shape (ROOM,)
        The points; gets what is covered from each, see `VALUE` and `CLEAR`.
    lanes : int
        How many there are, at most WIDTH.

    Returns
    -------
    error : float
        What that may leave out.
    """
    error, leaves, spared = 0.0, len(clusters.start) - 1, 0
    for i in range(lanes):
        seen[VALUE + i] = seen[IM + i] = 0.0
        seen[RE + i] = seen[CLEAR + i] = 1.0
    for top in among:
        k, end = top, after(top)
        while k != end:
            far = length(between(centre, clusters.sphere[k])) - reach
            off = left_out(clusters.sphere[k], far, 0.0)
            if off <= tolerance:
                _add_afar(clusters.moments[k], clusters.sphere[k], seen, lanes)
                error += off
            elif k < leaves:
                k *= 2
                continue
            else:
                for loop in range(clusters.start[k - leaves], clusters.start[k - leaves + 1]):
                    rim = clusters.rim[clusters.first[loop] : clusters.first[loop + 1]]
                    spared = _turn(rim, clusters.apex[loop], seen, lanes, spared)
            k = after(k)
    for i in range(lanes):
        seen[VALUE + i] += np.arctan2(seen[IM + i], seen[RE + i]) / (2 * np.pi)
    return error


@side_by_side
def _add_afar(moments, sphere, seen, lanes):
    """Add what a cluster covers from afar: the value of `moments.add_expansion`."""
    p = held(moments)
    cx, cy, cz = sphere[0], sphere[1], sphere[2]
    for i in range(lanes):
        x, y, z = cx - seen[i], cy - seen[Y + i], cz - seen[Z + i]
        near = 1 / np.sqrt(x * x + y * y + z * z)
        x, y, z = x * near, y * near, z * near
        rest = 7.5 * near * cube(p, x, y, z) - 3 * square(p, x, y, z)
        seen[VALUE + i] += (linear(p, x, y, z) + near * rest) * near * near / (4 * np.pi)


@lean
def _turn(rim, apex, seen, lanes, spared):
    """Turn angles by what one cap covers, as `view._turned` does for one point.

    `spared` triangles came since angles were scaled; returns how many it is now.
    """
    # Where the apex is the rim's first vertex, the edges next to it span nothing.
    begin, end = (2, len(rim)) if len(rim) <= 4 else (1, len(rim) + 1)
    for e in range(begin, end):
        _turn_by(apex, rim[e - 1], rim[e if e < len(rim) else 0], seen, lanes)
        spared += 1
        if spared == SPARED:
            _scale(seen, lanes)
            spared = 0
    return spared


@side_by_side
def _scale(seen, lanes):
    """Scale the complex numbers, so that further products stay within the floats."""
    for i in range(lanes):
        scale = 1 / (abs(seen[RE + i]) + abs(seen[IM + i]) + TINY)
        seen[RE + i] *= scale
        seen[IM + i] *= scale


@side_by_side
def _turn_by(p, q, r, seen, lanes):
    """Turn angles by a triangle p q r."""
    px, py, pz = p[0], p[1], p[2]
    qx, qy, qz = q[0], q[1], q[2]
    rx, ry, rz = r[0], r[1], r[2]
    for i in range(lanes):
        x, y, z = seen[i], seen[Y + i], seen[Z + i]
        cx, cy, cz = px - x, py - y, pz - z
        bx, by, bz = qx - x, qy - y, qz - z
        ax, ay, az = rx - x, ry - y, rz - z
        lc = np.sqrt(cx * cx + cy * cy + cz * cz)
        lb = np.sqrt(bx * bx + by * by + bz * bz)
        la = np.sqrt(ax * ax + ay * ay + az * az)
        triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        rest = la * lb * lc + (ax * bx + ay * by + az * bz) * lc
        rest += (bx * cx + by * cy + bz * cz) * la + (cx * ax + cy * ay + cz * az) * lb
        was, re = seen[IM + i], seen[RE + i]
        im = re * triple + was * rest
        re = re * rest - was * triple
        # Without a branch, which lanes cannot take each by itself.
        up = (was >= 0) & (triple >= 0) & (im < 0)
        down = (was < 0) & (triple < 0) & (im >= 0)
        seen[VALUE + i] += np.float64(up) - np.float64(down)
        seen[RE + i], seen[IM + i] = re, im
        clear = abs(triple) + max(rest, 0.0) - NEAR * la * lb * lc
        seen[CLEAR + i] = min(seen[CLEAR + i], clear)
