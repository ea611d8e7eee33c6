"""What caps cover of the view, summed cluster by cluster within proven bounds.

The solid angle over 4 pi of a surface seen from p is the integral of n . F(y - p) over it,
with F(r) = r / (4 pi |r|^3). Around the centre c of a cluster of caps and a place q near p,
r = R + h with R = c - q and h = (y - c) - (p - q), it is expanded to first order,

    n . F(R + h) = n . F(R) + n . DF(R) h + ...,    DF(R) = (1 - 3 R R^T / |R|^2) / (4 pi |R|^3).

Summed over the cluster, only its vector area A = sum of areas times normals and the moments
M = sum of area n (y - c)^T remain: it covers about A . F(R) + M : DF(R) - A . DF(R) (p - q).

What this leaves out. Along any line, 1/|R + h| is a power series whose k-th coefficient is a
Legendre polynomial of the angle over |R|^(k+1), at most 1 / |R|^(k+1); the k-th derivative is
k! times that, also between different directions (Banach 1938: a symmetric form is largest on
its diagonal). F is -1/(4 pi) times the gradient of 1/|r|, so the term of order k in h is at
most (k+1) x^k / (4 pi |R|^2) with x = |h| / |R|, and a cluster of total area S leaves out at most

    S / (4 pi |R|^2) sum_(k>1) (k+1) x^k = S / (4 pi |R|^2) (1 / (1 - x)^2 - 1 - 2 x).

The caps of loops nearby are summed exactly at q. Their gradient is, by Biot and Savart, the
integral of F x dr around the loop, whichever surface spans it, and its own derivatives at
most that of |DF| = 1 / (2 pi |r|^3). So within s of q a loop leaves out at most

    s^2 / 2 sum over its edges of length / (2 pi d^3),

with d the distance of an edge to the ball. This is so even if the cap runs through the ball,
but for the jump by one where it is passed: such a ball is called torn.

The same sum over clusters is how fast winding numbers work (Barill et al. 2018), there
without a bound.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .caps import Caps
from .solid_angle import between, cross, distance_to_edge, dot, is_within, length, turning

LEAF = 1
"""Loops in a cluster that is not halved any more, at most."""
DEPTH = 64
CLEAR = 1e-7
"""Nearer to a cap than this, relative to its size, rounding may put a point on either side."""


class Clusters(NamedTuple):
    """Caps in a balanced tree: cluster k is made up of clusters 2 k and 2 k + 1.

    Parameters
    ----------
    rim : array, shape (e, 3)
        The vertices of the loops, loop by loop. Loops are ordered along a curve that fills
        space.
    first : array, shape (l + 1,), int64
        Loop i has the vertices from first[i] to first[i + 1].
    apex : array, shape (l, 3)
        The point that the triangles of each cap share.
    start : array, shape (m + 1,), int64
        Loops of the cluster m + i, one that is not halved, are those from start[i] on.
    centre, radius, area : arrays, shapes (2 m, 3), (2 m,) and (2 m,)
        A sphere around each cluster, and the sum of its triangles' areas.
    vector, moment : arrays, shapes (2 m, 3) and (2 m, 3, 3)
        A and M.
    """

    rim: NDArray[np.float64]
    first: NDArray[np.int64]
    apex: NDArray[np.float64]
    start: NDArray[np.int64]
    centre: NDArray[np.float64]
    radius: NDArray[np.float64]
    area: NDArray[np.float64]
    vector: NDArray[np.float64]
    moment: NDArray[np.float64]


def cluster(caps: Caps) -> Clusters:
    """Sort caps into clusters."""
    loops = len(caps.apex)
    order = np.argsort(_curve(caps.vertices[caps.apex]))
    size = np.diff(caps.start)[order]
    first = np.concatenate([[0], np.cumsum(size)])
    place = np.arange(first[-1]) + np.repeat(caps.start[:-1][order] - first[:-1], size)
    rim, apex = caps.vertices[caps.loop[place]], caps.vertices[caps.apex[order]]
    leaves = 1
    while leaves * LEAF < loops:
        leaves *= 2
    start = np.arange(leaves + 1) * loops // leaves
    return Clusters(rim, first, apex, start, *_sum_up(rim, first, apex, start))


@njit(cache=True)
def _curve(points):
    """Return where points lie on a curve that fills the unit cube (Morton 1966)."""
    place = np.zeros(len(points), np.int64)
    for p in range(len(points)):
        for axis in range(3):
            cell = min(max(int(points[p, axis] * 1024), 0), 1023)
            for bit in range(10):
                place[p] |= (cell >> bit & 1) << (3 * bit + axis)
    return place


@njit(cache=True)
def _sum_up(rim, first, apex, start):
    leaves = len(start) - 1
    centre, radius, area = np.zeros((2 * leaves, 3)), np.zeros(2 * leaves), np.zeros(2 * leaves)
    vector, moment = np.zeros((2 * leaves, 3)), np.zeros((2 * leaves, 3, 3))
    for k in range(2 * leaves - 1, 0, -1):
        low = high = k
        while low < leaves:
            low, high = 2 * low, 2 * high + 1
        begin, end = first[start[low - leaves]], first[start[high - leaves + 1]]
        for e in range(begin, end):
            centre[k] += rim[e] / (end - begin)
        for e in range(begin, end):
            radius[k] = max(radius[k], length(between(centre[k], rim[e])))
        for loop in range(start[low - leaves], start[high - leaves + 1]):
            # An apex is a mean of vertices, and lies in the sphere with them.
            for e in range(first[loop], first[loop + 1]):
                b = rim[e]
                a = rim[e + 1] if e + 1 < first[loop + 1] else rim[first[loop]]
                normal = cross(between(a, b), between(a, apex[loop]))
                area[k] += length(normal) / 2
                for i in range(3):
                    vector[k, i] += normal[i] / 2
                    for j in range(3):
                        middle = (a[j] + b[j] + apex[loop, j]) / 3
                        moment[k, i, j] += normal[i] / 2 * (middle - centre[k, j])
    return centre, radius, area, vector, moment


@njit(cache=True, nogil=True)
def view(clusters, q, reach, tolerance, limit):
    """Return what all caps cover of the view, to first order around a place.

    Parameters
    ----------
    clusters : Clusters
    q : tuple of 3 floats
    reach : float
        Radius of the ball around q for which the result holds.
    tolerance : float
        Clusters that may leave out more than this are halved.
    limit : float
        Give up once more than this may be left out in all.

    Returns
    -------
    value : float
        At q.
    gradient : tuple of 3 floats
    error : float
        How far the caps' share may be from value + gradient . (p - q) for any p in the
        ball; infinite where q itself is too near to a cap for rounding.
    is_torn : bool
        Whether a cap enters the ball: then the share is right up to whole numbers.
    """
    value = gx = gy = gz = error = 0.0
    is_torn = False
    leaves = len(clusters.start) - 1
    stack = np.empty(DEPTH, np.int64)
    stack[0], size = 1, 1
    while size and error <= limit:
        size -= 1
        k = stack[size]
        r = between(q, clusters.centre[k])
        far = length(r)
        h = clusters.radius[k] + reach
        if h < far:
            x = h / far
            per_area = 1 / (4 * np.pi * far * far)
            left_out = clusters.area[k] * per_area * (1 / ((1 - x) * (1 - x)) - 1 - 2 * x)
            # Halving clusters helps little once the ball is what makes h large.
            if left_out <= tolerance or clusters.radius[k] < reach / 4:
                r = r[0] / far, r[1] / far, r[2] / far
                a, m = clusters.vector[k], clusters.moment[k]
                ahead = dot(a, r)
                turned = m[0, 0] + m[1, 1] + m[2, 2]
                turned -= 3 * (r[0] * dot(m[0], r) + r[1] * dot(m[1], r) + r[2] * dot(m[2], r))
                value += per_area * (ahead + turned / far)
                gx -= per_area / far * (a[0] - 3 * r[0] * ahead)
                gy -= per_area / far * (a[1] - 3 * r[1] * ahead)
                gz -= per_area / far * (a[2] - 3 * r[2] * ahead)
                error += left_out
                continue
        if k < leaves:
            near, other = 2 * k, 2 * k + 1
            if _is_nearer(clusters.centre, other, near, q):
                near, other = other, near
            stack[size], stack[size + 1] = other, near  # the near ones exceed the limit first
            size += 2
            continue
        for loop in range(clusters.start[k - leaves], clusters.start[k - leaves + 1]):
            rim = clusters.rim[clusters.first[loop] : clusters.first[loop + 1]]
            if reach > 0:
                may_tear = far <= h
                g, left_out, cuts = _change(rim, clusters.apex[loop], q, reach, limit, may_tear)
                gx, gy, gz = gx + g[0], gy + g[1], gz + g[2]
                error += left_out
                is_torn |= cuts
                if error > limit:
                    break
            share, is_clear = _covered(rim, clusters.apex[loop], q)
            value += share
            if reach == 0 and not is_clear:
                error = np.inf
    return value, (gx, gy, gz), error, is_torn


@njit(cache=True, inline="always")
def _is_nearer(centre, k, other, q):
    a, b = between(q, centre[k]), between(q, centre[other])
    return dot(a, a) < dot(b, b)


@njit(cache=True)
def _covered(rim, apex, q):
    """Return what one cap covers, and whether that is clear of rounding.

    Half the solid angle of a triangle is the angle of a complex number (van Oosterom &
    Strackee 1983). Their product has the sum of the angles, up to whole turns, which are
    counted: two angles on one side of the real axis pass the far side if their sum does not
    stay there.
    """
    x, y, turns = 1.0, 0.0, 0
    is_clear = True
    # Where the apex is the rim's first vertex, the edges next to it span nothing.
    begin, end = (2, len(rim)) if len(rim) <= 4 else (1, len(rim) + 1)
    c = between(q, apex)
    b = between(q, rim[begin - 1])
    lc, lb = length(c), length(b)
    for e in range(begin, end):
        a = between(q, rim[e] if e < len(rim) else rim[0])
        la = length(a)
        triple = dot(a, cross(b, c))
        rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        is_clear &= abs(triple) + max(rest, 0.0) > CLEAR * la * lb * lc
        after = x * triple + y * rest
        x, was = x * rest - y * triple, y
        y = after
        if was >= 0 and triple >= 0 and y < 0:
            turns += 1
        elif was < 0 and triple < 0 and y >= 0:
            turns -= 1
        if e % 8 == 0:  # else products of many small numbers vanish
            size = abs(x) + abs(y)
            x, y = x / size, y / size
        b, lb = a, la
    return turns + np.arctan2(y, x) / (2 * np.pi), is_clear


@njit(cache=True)
def _change(rim, apex, q, reach, limit, may_tear):
    """Return the gradient of what a cap covers, what that leaves out, and if it is torn."""
    gx = gy = gz = error = 0.0
    is_torn = False
    c = between(q, apex)
    b = between(q, rim[len(rim) - 1])
    lb = length(b)
    for e in range(len(rim)):
        a, la = b, lb
        b = between(q, rim[e])
        lb = length(b)
        side = length(between(a, b))
        # No point of an edge is nearer than half of what the way over its ends is longer.
        gap = (la + lb - side) / 2 - reach
        if gap < side:
            gap = distance_to_edge(a, b) - reach
            if gap <= 0:
                return (gx, gy, gz), np.inf, True
        error += reach * reach / 2 * side / (2 * np.pi * gap * gap * gap)
        if error > limit:
            break
        g = turning(b, a, lb, la)
        gx, gy, gz = gx + g[0], gy + g[1], gz + g[2]
        if may_tear and not is_torn:
            is_torn = is_within(b, a, c, reach)
    return (gx, gy, gz), error, is_torn
