"""Caps in clusters: what each covers of the view from afar, within a proven bound.

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

The same sum over clusters is how fast winding numbers work (Barill et al. 2018), there
without a bound.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..threads import in_threads
from .caps import Caps
from .solid_angle import between, cross, dot, length

ROOT = 1
"""The cluster of all caps."""


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
        Loops of the cluster m + i, one that is not halved, are those from start[i] on: one
        or none.
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
    while leaves < loops:
        leaves *= 2
    start = np.arange(leaves + 1) * loops // leaves
    centre, area, vector, moment = _sum_up(rim, first, apex, start)
    radius = np.zeros(len(centre))
    step = 16 if loops > 1000 else 1  # few are done before a thread has begun
    in_threads(
        lambda part: _surround(rim, first, start, centre, part, step, radius), range(1, step + 1)
    )
    return Clusters(rim, first, apex, start, centre, radius, area, vector, moment)


@njit(cache=True, nogil=True)
def _curve(points):
    """Return where points lie on a curve that fills the unit cube (Morton 1966)."""
    place = np.zeros(len(points), np.int64)
    for p in range(len(points)):
        for axis in range(3):
            cell = min(max(int(points[p, axis] * 1024), 0), 1023)
            for bit in range(10):
                place[p] |= (cell >> bit & 1) << (3 * bit + axis)
    return place


@njit(cache=True, nogil=True)
def _sum_up(rim, first, apex, start):
    """Return centre, area, vector area and moments of each cluster."""
    leaves = len(start) - 1
    centre, area, count = np.zeros((2 * leaves, 3)), np.zeros(2 * leaves), np.zeros(2 * leaves)
    vector, moment = np.zeros((2 * leaves, 3)), np.zeros((2 * leaves, 3, 3))
    for k in range(2 * leaves - 1, 0, -1):
        if k >= leaves:
            for loop in range(start[k - leaves], start[k - leaves + 1]):
                ring = rim[first[loop] : first[loop + 1]]
                count[k] = len(ring)
                for e in range(len(ring)):
                    centre[k] += ring[e] / len(ring)
                area[k] = _add_fan(ring, apex[loop], centre[k], vector[k], moment[k])
            continue
        count[k] = count[2 * k] + count[2 * k + 1]
        area[k] = area[2 * k] + area[2 * k + 1]
        for half in (2 * k, 2 * k + 1):
            for i in range(3):
                centre[k, i] += centre[half, i] * (count[half] / count[k])
                vector[k, i] += vector[half, i]
        for half in (2 * k, 2 * k + 1):
            for i in range(3):
                for j in range(3):
                    moved = centre[half, j] - centre[k, j]
                    moment[k, i, j] += moment[half, i, j] + vector[half, i] * moved
    return centre, area, vector, moment


@njit(cache=True)
def _add_fan(ring, apex, centre, vector, moment):
    """Add the vector area and moments of one cap; return its area."""
    area = 0.0
    for e in range(len(ring)):
        a, b = ring[(e + 1) % len(ring)], ring[e]
        normal = cross(between(a, b), between(a, apex))
        area += length(normal) / 2
        for i in range(3):
            vector[i] += normal[i] / 2
            for j in range(3):
                moment[i, j] += normal[i] / 2 * ((a[j] + b[j] + apex[j]) / 3 - centre[j])
    return area


@njit(cache=True, nogil=True)
def _surround(rim, first, start, centre, part, step, radius):
    """Find the radius of each so-manieth cluster, from `part` on."""
    leaves = len(start) - 1
    for k in range(part, 2 * leaves, step):
        low = high = k
        while low < leaves:
            low, high = 2 * low, 2 * high + 1
        # An apex is a mean of vertices, and lies in the sphere with them.
        for e in range(first[start[low - leaves]], first[start[high - leaves + 1]]):
            away = between(centre[k], rim[e])
            radius[k] = max(radius[k], dot(away, away))
        radius[k] = np.sqrt(radius[k])


@njit(cache=True, inline="always")
def left_out(clusters, k, far, reach):
    """Return what the expansion of a cluster leaves out in a ball as far off as that."""
    x = (clusters.radius[k] + reach) / far if far > 0 else np.inf
    if x >= 1:
        return np.inf
    return clusters.area[k] / (4 * np.pi * far * far) * (1 / ((1 - x) * (1 - x)) - 1 - 2 * x)


@njit(cache=True, inline="always")
def expansion(clusters, k, r, far):
    """Return what a cluster at r, as far off as that, covers, and the gradient of that."""
    per_area = 1 / (4 * np.pi * far * far)
    n = r[0] / far, r[1] / far, r[2] / far
    a, m = clusters.vector[k], clusters.moment[k]
    ahead = dot(a, n)
    turned = m[0, 0] + m[1, 1] + m[2, 2]
    turned -= 3 * (n[0] * dot(m[0], n) + n[1] * dot(m[1], n) + n[2] * dot(m[2], n))
    value = per_area * (ahead + turned / far)
    slope = -per_area / far
    gx, gy, gz = a[0] - 3 * n[0] * ahead, a[1] - 3 * n[1] * ahead, a[2] - 3 * n[2] * ahead
    return value, gx * slope, gy * slope, gz * slope
