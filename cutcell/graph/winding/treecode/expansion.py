"""Winding number of the caps in a ball, as a local expansion with a proven error.

A local (Taylor) expansion is a row of EXPANSION_SIZE numbers: value, gradient (x, y, z), the second
derivatives (xx, yy, xy, xz, yz), and a bound of the error; zz = -xx - yy, as the function is
harmonic.

Distant clusters add their multipole moments, see `clusters.py` for the error. The caps of near
loops are summed exactly at the centre q. Their gradient is, by Biot and Savart's law, the integral
of F x dr around the loop, whichever surface spans it; its own derivatives are at most those of F,
|DF| = 1 / (2 pi |r|^3). So within s of q the gradient of a loop leaves out at most

    s^2 / 2 sum over its edges of length / (2 pi d^3),

with d the distance of an edge to the ball. Only the rim has to keep away from the ball. In a ball
crossed by a cap the winding number jumps by one across it, but is smooth otherwise: the expansion
is then valid up to whole numbers. Where a rim enters the ball, the error is infinite.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....geometry.vectors import between, cross, dot, length, segment_fraction, triangle_normal
from ....runtime.compiled import inlined, no_refcount
from .clusters import error_bound, next_cluster
from .multipole import add_multipole

EXPANSION_SIZE = 10
ERROR = EXPANSION_SIZE - 1
"""The column of the error bound."""
FAR_ERROR = 5e-3
"""A cluster whose error in a ball is at most this is far from the ball."""
ROUNDING_ERROR = 1e-9
"""Beyond the error bound, for rounding."""
COARSE = 0.3
"""Near clusters of a larger error are split, to see if parts of them are far."""
RESCALED_BELOW = 1e-60
"""Products are rescaled below this, and above its inverse, before they under- or overflow."""
USELESS = 0.5
"""With a larger error an expansion decides nothing."""


class LocalExpansions(NamedTuple):
    """Local expansions of the winding number of the caps in blocks of cells.

    Parameters
    ----------
    centre : array, shape (n, 3)
    local : array, shape (n, EXPANSION_SIZE)
        Of all caps, or of all but those of the near clusters.
    start : array, shape (n + 1,), int64
        The near clusters are near[start[i]] to near[start[i + 1] - 1].
    near : array, int32
    """

    centre: NDArray[np.float64]
    local: NDArray[np.float64]
    start: NDArray[np.int64]
    near: NDArray[np.int32]


@inlined
def evaluate(local, x, y, z):
    """Return the value at a displacement (x, y, z) from the centre."""
    linear = local[1] * x + local[2] * y + local[3] * z
    square = local[4] * (x * x - z * z) + local[5] * (y * y - z * z)
    return local[0] + linear + square / 2 + local[6] * x * y + local[7] * x * z + local[8] * y * z


@inlined
def translate(local, x, y, z):
    """Move the centre by (x, y, z)."""
    local[0] = evaluate(local, x, y, z)
    local[1] += local[4] * x + local[6] * y + local[7] * z
    local[2] += local[6] * x + local[5] * y + local[8] * z
    local[3] += local[7] * x + local[8] * y - (local[4] + local[5]) * z


@inlined
def variation(local, half):
    """Bound how far values differ from the one at the centre, in a cube of that half side."""
    linear = abs(local[1]) + abs(local[2]) + abs(local[3])
    square = (abs(local[4]) + abs(local[5]) + abs(local[4] + local[5])) / 2
    return half * (linear + half * (square + abs(local[6]) + abs(local[7]) + abs(local[8])))


@no_refcount
def add_far_clusters(clusters, among, local, near, q, reach):
    """Add the clusters that are far from a ball to its expansion, and list the others.

    Shapes: local (EXPANSION_SIZE,).
    """
    count = 0
    leaves = len(clusters.start) - 1
    for top in among:
        k = np.int64(top)
        end = next_cluster(k)
        while k != end:
            r, distance, error = _relative(clusters, k, q, reach)
            if error <= FAR_ERROR:
                add_multipole(local, clusters.moments[k], r, distance)
                local[ERROR] += error
            elif error > COARSE and clusters.sphere[k, 3] > reach and k < leaves:
                k *= 2
                continue
            else:
                near[count] = k
                count += 1
            k = next_cluster(k)
    return count


@no_refcount
def add_clusters(clusters, among, local, q, reach, tolerance):
    """Add clusters to a ball's local expansion (EXPANSION_SIZE,), until its error is useless."""
    leaves = len(clusters.start) - 1
    for top in among:
        k = np.int64(top)
        end = next_cluster(k)
        while k != end:
            r, distance, error = _relative(clusters, k, q, reach)
            # Splitting helps little where it is the ball's radius that makes the error large.
            if error <= tolerance or (error < np.inf and clusters.sphere[k, 3] < reach / 4):
                add_multipole(local, clusters.moments[k], r, distance)
                local[ERROR] += error
            elif k < leaves:
                k *= 2
                continue
            else:
                for loop in range(clusters.start[k - leaves], clusters.start[k - leaves + 1]):
                    rim = clusters.rim[clusters.first[loop] : clusters.first[loop + 1]]
                    _add_gradient(local, rim, clusters.apex[loop], q, reach, error == np.inf)
                    if local[ERROR] > USELESS:
                        return
                    local[0] += _winding_number(rim, clusters.apex[loop], q)
            if local[ERROR] > USELESS:
                return
            k = next_cluster(k)


@no_refcount
def _winding_number(rim, apex, q):
    """Return the winding number of one cap at q: `solid_angles.add_cap` at a single point."""
    x, y, turns = 1.0, 0.0, 0.0
    # Where the apex is the rim's first vertex, the edges at it span no triangle.
    begin, end = (2, len(rim)) if len(rim) <= 4 else (1, len(rim) + 1)
    c = between(q, apex)
    b = between(q, rim[begin - 1])
    lc, lb = length(c), length(b)
    for e in range(begin, end):
        a = between(q, rim[e] if e < len(rim) else rim[0])
        la = length(a)
        triple = dot(a, cross(b, c))
        rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        was, y = y, x * triple + y * rest
        x = x * rest - was * triple
        if was >= 0 and triple >= 0 and y < 0:
            turns += 1
        elif was < 0 and triple < 0 and y >= 0:
            turns -= 1
        size = abs(x) + abs(y)
        if 0 < size < RESCALED_BELOW or size > 1 / RESCALED_BELOW:
            x, y = x / size, y / size
        b, lb = a, la
    return turns + np.arctan2(y, x) / (2 * np.pi)


@inlined
def _relative(clusters, k, q, reach):
    """Return a cluster's centre relative to q, its distance, and the error of its expansion."""
    r = between(q, clusters.sphere[k])
    distance = length(r)
    return r, distance, error_bound(clusters.sphere[k], distance, reach)


@no_refcount
def _add_gradient(local, rim, apex, q, reach, may_cross):
    """Add the gradient of a cap, and its error: infinite if the cap crosses the ball."""
    c = between(q, apex)
    b = between(q, rim[len(rim) - 1])
    lb = length(b)
    for e in range(len(rim)):
        a, la = b, lb
        b = between(q, rim[e])
        lb = length(b)
        side = length(between(a, b))
        # Triangle inequality: no point of the edge is nearer than this.
        gap = (la + lb - side) / 2 - reach
        if gap < side:
            gap = _distance_to_edge(a, b) - reach
        if gap <= 0 or (may_cross and _is_within(b, a, c, reach)):
            local[ERROR] = np.inf
            return
        local[ERROR] += reach * reach / 2 * side / (2 * np.pi * gap * gap * gap)
        if local[ERROR] > USELESS:
            return
        g = _biot_savart(b, a, lb, la)
        local[1] += g[0]
        local[2] += g[1]
        local[3] += g[2]


@inlined
def _biot_savart(a, b, la, lb):
    """Return the integral of r x dr / (4 pi |r|^3) along an edge from a to b.

    It is the edge's part of the gradient of the solid angle over 4 pi. a and b are relative to the
    point, la and lb their lengths.
    """
    n = cross(a, b)
    below = la * lb * (la * lb + dot(a, b))
    factor = (la + lb) / (4 * np.pi * below) if below > 0 else 0.0
    return n[0] * factor, n[1] * factor, n[2] * factor


@inlined
def _distance_to_edge(a, b):
    """Return the distance of the origin to the edge between a and b."""
    e, t = between(a, b), segment_fraction(a, b, (0.0, 0.0, 0.0))
    return length((a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]))


@no_refcount
def _is_within(a, b, c, reach):
    """Return whether a triangle comes within reach of the origin, without its edge a, b."""
    n = triangle_normal(a, b, c)
    height = dot(a, n)
    if height * height > reach * reach * dot(n, n):
        return False
    # The plane is within reach. The foot is in the triangle if on one side of all edges.
    if dot(n, cross(a, b)) > 0 and dot(n, cross(b, c)) > 0 and dot(n, cross(c, a)) > 0:
        return True
    return min(_distance_to_edge(a, c), _distance_to_edge(b, c)) <= reach
