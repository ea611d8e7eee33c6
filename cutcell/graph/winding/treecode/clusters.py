"""A treecode over the caps: clusters with multipole moments and a proven error bound.

The winding number of a surface at p, its solid angle over 4 pi, is the integral of n . F(y - p)
over it, with F(r) = r / (4 pi |r|^3). For a cluster of caps with centre c and a point q near p,
write r = R + h with R = c - q and h = (y - c) - (p - q), and expand to second order in h around R.
Summed over the cluster, this needs only moments of y - c, see `multipole.py`: the vector area, and
the sums of area times normal times y - c, to the first and to the second power,

    A(n) = sum area (normal . n) (y - c . n)^0,   M(n) and Q(n) with its first and second power.

Error bound. Along any line, 1/|R + h| is a power series whose k-th coefficient is a
Legendre polynomial of the angle over |R|^(k+1), at most 1 / |R|^(k+1); the k-th derivative is
k! times that, also between different directions (Banach 1938: a symmetric form is largest on
its diagonal). F is -1/(4 pi) times the gradient of 1/|r|, so the term of order k in h is at
most (k+1) x^k / (4 pi |R|^2) with x = |h| / |R|. Within a ball of radius s around q, |h| is at most
r + s for a cluster of radius r, and the mean of its cube over the cluster's area S is at most
(m + s)^3 (Minkowski), with m the cubic mean of the distances to the centre. So the error is at most

    S / (4 pi |R|^2) mean of sum_(k>2) (k+1) x^k
        = S / (4 pi |R|^2) ((m + s) / |R|)^3 (4 - 3 X) / (1 - X)^2,   X = (r + s) / |R|.

m is often only half of r, which makes the bound eight times smaller.

Fast winding numbers (Barill et al. 2018) are the same expansion, without a bound.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....geometry.triangles import areas
from ....runtime.compiled import inlined
from ..boundary import Caps
from . import multipole

ROOT = 1
"""The index of the cluster of all caps."""
NO_AREA = 1e-300
"""In place of the area of a cluster without one."""
CAPS_A_LEAF = 4
"""Caps in a leaf of the tree, at most."""


class Clusters(NamedTuple):
    """Caps in a balanced binary tree: the children of cluster k are 2 k and 2 k + 1.

    Parameters
    ----------
    rim : array, shape (e, 3)
        The vertices of the loops, loop by loop.
    first : array, shape (l + 1,), int64
        Loop i has the vertices from first[i] to first[i + 1].
    apex : array, shape (l, 3)
        The apex of each cap: the point that its triangles share.
    start : array, shape (m + 1,), int64
        The loops of leaf i, which is cluster m + i, are start[i] to start[i + 1] - 1.
    sphere : array, shape (2 m, 6)
        Of each cluster: centre and radius; an upper bound of the cubic mean of the distances
        from the centre; and the sum of the areas of its triangles.
    moments : array, shape (2 m, multipole.MOMENTS_SIZE)
    """

    rim: NDArray[np.float64]
    first: NDArray[np.int64]
    apex: NDArray[np.float64]
    start: NDArray[np.int64]
    sphere: NDArray[np.float64]
    moments: NDArray[np.float64]


def build_tree(caps: Caps) -> Clusters:
    """Sort caps into a tree of clusters."""
    order, start = _sort(caps.vertices[caps.apex])
    size = np.diff(caps.start)[order]
    first = np.concatenate([[0], np.cumsum(size)])
    place = np.arange(first[-1]) + np.repeat(caps.start[:-1][order] - first[:-1], size)
    rim, apex = caps.vertices[caps.loop[place]], caps.vertices[caps.apex[order]]
    return Clusters(rim, first, apex, start, *_measure(rim, first, apex, start))


def _sort(points: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Sort points (l, 3) into leaves, halving clusters across their longest axis.

    Returns the order, shape (l,), and where each leaf begins in it, (m + 1,).
    """
    count, level, leaves = len(points), 1, 1
    while leaves * CAPS_A_LEAF < count:
        leaves *= 2
    order, start = np.arange(count), np.arange(leaves + 1) * count // leaves
    while level < leaves:
        bounds, ordered = start[:: leaves // level], points[order]
        low, high = (f.reduceat(ordered, bounds[:-1]) for f in (np.minimum, np.maximum))
        size = np.diff(bounds)
        along = np.repeat((high - low).argmax(axis=1), size)
        cluster = np.repeat(np.arange(level), size)
        # Coordinates are below 1.
        order = order[np.argsort(2 * cluster + ordered[np.arange(count), along], kind="stable")]
        level *= 2
    return order, start


def _measure(
    rim: NDArray[np.float64],
    first: NDArray[np.int64],
    apex: NDArray[np.float64],
    start: NDArray[np.int64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute spheres and moments, see `Clusters`."""
    leaves = len(start) - 1
    sphere = np.zeros((2 * leaves, 6))
    if len(rim) == 0:
        return sphere, np.zeros((2 * leaves, multipole.MOMENTS_SIZE))
    before = np.arange(len(rim)) - 1
    before[first[:-1]] = first[1:] - 1
    corners = np.stack([rim, rim[before], np.repeat(apex, np.diff(first), axis=0)], axis=1)
    area = areas(corners)
    # The cube of a distance is convex: its mean over a triangle is at most that over the corners.
    of_rim, of_apex = area.copy(), np.add.reduceat(area, first[:-1])
    of_rim[before] += area
    level = leaves
    while level:
        loops = start[:: leaves // level]
        bounds, rows = first[loops], slice(level, 2 * level)
        size = np.diff(bounds)
        centre = np.add.reduceat(rim, bounds[:-1]) / size[:, None]
        whole = np.add.reduceat(area, bounds[:-1])
        away = np.linalg.norm(rim - np.repeat(centre, size, axis=0), axis=1)
        apex_away = np.linalg.norm(apex - np.repeat(centre, np.diff(loops), axis=0), axis=1)
        # An apex is a mean of rim vertices, so it lies within the radius, too.
        radius = np.maximum.reduceat(away, bounds[:-1])
        cubes = np.add.reduceat(of_rim * away**3, bounds[:-1])
        cubes += np.add.reduceat(of_apex * apex_away**3, loops[:-1])
        mean = np.cbrt(cubes / (3 * np.maximum(whole, NO_AREA)))
        sphere[rows] = np.stack([*centre.T, radius, np.minimum(mean, radius), whole], axis=1)
        level //= 2
    return sphere, multipole.moments_of(corners, first[start[:-1]], sphere[:, :3])


@inlined
def error_bound(sphere, distance, reach):
    """Bound the error of a cluster's expansion in a ball of radius `reach` at that distance."""
    room = distance - sphere[3] - reach
    if room <= 0:
        return np.inf
    near = sphere[4] + reach
    series = 4 * distance - 3 * (sphere[3] + reach)
    squared = distance * distance
    return sphere[5] * near * near * near * series / (4 * np.pi * squared * squared * room * room)


@inlined
def next_cluster(k):
    """Return the cluster that follows k and its descendants in depth-first order; 0 at the end."""
    while k & 1:
        k >>= 1
    return k + 1 if k else 0
