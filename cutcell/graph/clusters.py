"""Caps in clusters: what each covers of the view from afar, within a proven bound.

The solid angle over 4 pi of a surface seen from p is the integral of n . F(y - p) over it,
with F(r) = r / (4 pi |r|^3). Around the centre c of a cluster of caps and a place q near p,
r = R + h with R = c - q and h = (y - c) - (p - q), it is expanded to second order in h, with
the derivatives of F at R. Summed over the cluster, only moments of y - c remain, see
`moments.py`: its vector area and the sums of area times normal times y - c, once and twice,

    A(n) = sum area (normal . n) (y - c . n)^0,   M(n) and Q(n) with its first and second power.

What this leaves out. Along any line, 1/|R + h| is a power series whose k-th coefficient is a
Legendre polynomial of the angle over |R|^(k+1), at most 1 / |R|^(k+1); the k-th derivative is
k! times that, also between different directions (Banach 1938: a symmetric form is largest on
its diagonal). F is -1/(4 pi) times the gradient of 1/|r|, so the term of order k in h is at
most (k+1) x^k / (4 pi |R|^2) with x = |h| / |R|. Within a ball of radius s around q, |h| is at most
r + s for a cluster of radius r, and the mean of its cube over the cluster's area S is at most
(m + s)^3 (Minkowski), with m the cubic mean of the distances to the centre. It leaves out at most

    S / (4 pi |R|^2) mean of sum_(k>2) (k+1) x^k
        = S / (4 pi |R|^2) ((m + s) / |R|)^3 (4 - 3 X) / (1 - X)^2,   X = (r + s) / |R|.

m is often but half of r, and the bound so much smaller.

The same sum over clusters is how fast winding numbers work (Barill et al. 2018), there
without a bound.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled, lean
from ..threads import in_threads, parts
from . import moments
from .caps import Caps
from .solid_angle import between, dot

ROOT = 1
"""The cluster of all caps."""
TOGETHER = 4
"""Caps in a cluster that is not halved, at most."""


class Clusters(NamedTuple):
    """Caps in a balanced tree: cluster k is made up of clusters 2 k and 2 k + 1.

    Parameters
    ----------
    rim : array, shape (e, 3)
        The vertices of the loops, loop by loop.
    first : array, shape (l + 1,), int64
        Loop i has the vertices from first[i] to first[i + 1].
    apex : array, shape (l, 3)
        The point that the triangles of each cap share.
    start : array, shape (m + 1,), int64
        Loops of the cluster m + i, one that is not halved, are those from start[i] on.
    sphere : array, shape (2 m, 6)
        Around each cluster: centre and radius; the cubic mean of the distances from the
        centre (no less than that); and the sum of its triangles' areas.
    moments : array, shape (2 m, moments.SIZE)
    """

    rim: NDArray[np.float64]
    first: NDArray[np.int64]
    apex: NDArray[np.float64]
    start: NDArray[np.int64]
    sphere: NDArray[np.float64]
    moments: NDArray[np.float64]


def cluster(caps: Caps) -> Clusters:
    """Sort caps into clusters."""
    loops, leaves = len(caps.apex), 1
    while leaves * TOGETHER < loops:
        leaves *= 2
    start = np.arange(leaves + 1) * loops // leaves
    order, points = np.arange(loops), caps.vertices[caps.apex]
    level = 1
    while level < leaves:
        rows = [(level + part.start, level + part.stop) for part in parts(level)]
        in_threads(lambda row: _halve(points, start, order, *row), rows)
        level *= 2
    size = np.diff(caps.start)[order]
    first = np.concatenate([[0], np.cumsum(size)])
    place = np.arange(first[-1]) + np.repeat(caps.start[:-1][order] - first[:-1], size)
    rim, apex = caps.vertices[caps.loop[place]], caps.vertices[caps.apex[order]]
    sphere, summed, weight = _sum_up(rim, first, apex, start)
    step = 16 if loops > 1000 else 1  # few are done before a thread has begun
    in_threads(
        lambda part: _surround(rim, first, apex, start, weight, part, step, sphere),
        range(1, step + 1),
    )
    return Clusters(rim, first, apex, start, sphere, summed)


@lean
def _halve(points, start, order, first, last):
    """Order the points of clusters so that each half is on one side of a plane across it."""
    leaves = len(start) - 1
    for k in range(first, last):
        low = high = k
        while low < leaves:
            low, high = 2 * low, 2 * high + 1
        begin, middle, end = (
            start[low - leaves],
            start[(low + high + 1) // 2 - leaves],
            start[high - leaves + 1],
        )
        longest, across = -1.0, 0
        for axis in range(3):
            least = most = points[order[begin], axis]
            for i in range(begin, end):
                least = min(least, points[order[i], axis])
                most = max(most, points[order[i], axis])
            if most - least >= longest:
                longest, across = most - least, axis
        _divide(points, order, across, begin, middle, end)


@lean
def _divide(points, order, axis, begin, middle, end):
    """Put those that come first along an axis before the middle of a range (Hoare's FIND, 1961)."""
    while end - begin > 1:
        pivot = points[order[(begin + end) // 2], axis]
        i, j = begin, end - 1
        while i <= j:
            while points[order[i], axis] < pivot:
                i += 1
            while points[order[j], axis] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i, j = i + 1, j - 1
        if middle <= j:
            end = j + 1
        elif middle >= i:
            begin = i
        else:
            return


@compiled
def _sum_up(rim, first, apex, start):
    """Return the spheres, but for their radii; the moments; and the areas next to rim, apex."""
    leaves = len(start) - 1
    count, sphere = np.zeros(2 * leaves), np.zeros((2 * leaves, 6))
    weight = np.zeros(len(rim)), np.zeros(len(apex))
    summed = np.zeros((2 * leaves, moments.SIZE))
    for k in range(2 * leaves - 1, 0, -1):
        centre = sphere[k, :3]
        if k >= leaves:
            begin, end = start[k - leaves], start[k - leaves + 1]
            count[k] = first[end] - first[begin]
            for e in range(first[begin], first[end]):
                for i in range(3):
                    centre[i] += rim[e, i] / count[k]
            for loop in range(begin, end):
                span = first[loop], first[loop + 1]
                area = _add_fan(rim, span, apex[loop], centre, summed[k], weight[0])
                weight[1][loop] = area
                sphere[k, 5] += area
            continue
        count[k] = count[2 * k] + count[2 * k + 1]
        sphere[k, 5] = sphere[2 * k, 5] + sphere[2 * k + 1, 5]
        for half in (2 * k, 2 * k + 1):
            for i in range(3):
                centre[i] += sphere[half, i] * (count[half] / count[k])
        for half in (2 * k, 2 * k + 1):
            moments.add_moved(summed[k], summed[half], between(centre, sphere[half]))
    for k in range(1, 2 * leaves):
        moments.make_harmonic(summed[k])
    return sphere, summed, weight


@compiled
def _add_fan(rim, span, apex, centre, summed, weight):
    """Add the moments of one cap, and its triangles' areas to those next to the rim."""
    begin, end = span
    total, before = 0.0, end - 1
    c, b = between(centre, apex), between(centre, rim[before])
    for e in range(begin, end):
        a, b = b, between(centre, rim[e])
        area = moments.add_triangle(summed, b, a, c)
        weight[before] += area
        weight[e] += area
        total, before = total + area, e
    return total


@compiled
def _surround(rim, first, apex, start, weight, part, step, sphere):
    """Find the radius and the cubic mean of each so-manieth cluster, from `part` on.

    The cube of a distance is convex: its mean over a triangle is at most that of the corners.
    """
    leaves = len(start) - 1
    for k in range(part, 2 * leaves, step):
        low = high = k
        while low < leaves:
            low, high = 2 * low, 2 * high + 1
        low, high = start[low - leaves], start[high - leaves + 1]
        # An apex is a mean of vertices, and lies in the sphere with them.
        squared = total = 0.0
        for e in range(first[low], first[high]):
            away = between(sphere[k], rim[e])
            s = dot(away, away)
            squared = max(squared, s)
            total += weight[0][e] * s * np.sqrt(s)
        for loop in range(low, high):
            away = between(sphere[k], apex[loop])
            s = dot(away, away)
            total += weight[1][loop] * s * np.sqrt(s)
        sphere[k, 3] = np.sqrt(squared)
        mean = (total / (3 * sphere[k, 5])) ** (1 / 3) if total > 0 else 0.0
        sphere[k, 4] = min(mean, sphere[k, 3])


@compiled(inline="always")
def left_out(sphere, far, reach):
    """Return what the expansion of a cluster leaves out in a ball as far off as that."""
    room = far - sphere[3] - reach
    if room <= 0:
        return np.inf
    near = sphere[4] + reach
    series = 4 * far - 3 * (sphere[3] + reach)
    squared = far * far
    return sphere[5] * near * near * near * series / (4 * np.pi * squared * squared * room * room)
