"""What all caps cover of the view, near and far, within a proven bound.

Far clusters are expanded, see `clusters.py`. What they cover in a ball around a place is
kept as a field: a value, its gradient, and how much the two leave out. A smaller ball
within takes the field over, and only what was too near for it is looked at again.

The caps of loops nearby are summed exactly at q. Their gradient is, by Biot and Savart, the
integral of F x dr around the loop, whichever surface spans it, and its own derivatives at
most that of |DF| = 1 / (2 pi |r|^3). So within s of q a loop leaves out at most

    s^2 / 2 sum over its edges of length / (2 pi d^3),

with d the distance of an edge to the ball. This is so even if the cap runs through the ball,
but for the jump by one where it is passed: such a ball is called torn.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from .clusters import expansion, left_out
from .rays import grown
from .solid_angle import between, cross, distance_to_edge, dot, is_within, length, turning

DEPTH = 64
FAR = 1e-3
"""What a cluster that counts as far may leave out in a block."""
CLEAR = 1e-7
"""Nearer to a cap than this, relative to its size, rounding may put a point on either side."""


class Field(NamedTuple):
    """A linear function around a place: value + (x, y, z) . (p - place), right within error."""

    value: float
    x: float
    y: float
    z: float
    error: float


NOTHING = Field(0.0, 0.0, 0.0, 0.0, 0.0)


@njit(cache=True, inline="always")
def moved(field, a, b):
    """Return the field of a place a as one of a place b."""
    value = field.value + field.x * (b[0] - a[0]) + field.y * (b[1] - a[1])
    value += field.z * (b[2] - a[2])
    return Field(value, field.x, field.y, field.z, field.error)


@njit(cache=True, nogil=True)
def gather(clusters, listed, begin, end, q, reach, closest, field):
    """Add what is far from a ball to its field, and list what is not.

    Parameters
    ----------
    clusters : Clusters
    listed : array, int64
        Clusters to look at, from `begin` to `end`. What is too near is listed behind them.
    q, reach : tuple of 3 floats, float
        The ball.
    closest : float
        How large (radius of cluster + reach) / distance may be for it to count as far.
    field : Field
        At q, of all the other clusters.

    Returns
    -------
    listed, last : the list, longer if need be, and where what is near ends
    field : Field
    """
    value, gx, gy, gz, error = field
    leaves, last, touching = len(clusters.start) - 1, end, end
    stack = np.empty(DEPTH, np.int64)
    for place in range(begin, end):
        stack[0], size = listed[place], 1
        while size:
            size -= 1
            k = stack[size]
            r = between(q, clusters.centre[k])
            far = length(r)
            off = left_out(clusters, k, far, reach)
            if off <= FAR and clusters.radius[k] + reach <= closest * far:
                v, x, y, z = expansion(clusters, k, r, far)
                value, gx, gy, gz = value + v, gx + x, gy + y, gz + z
                error += off
            elif k < leaves and clusters.radius[k] >= reach / 2:
                stack[size], stack[size + 1] = 2 * k, 2 * k + 1
                size += 2
            else:
                if last == len(listed):
                    listed = grown(listed)
                listed[last] = k
                if off == np.inf:  # what may touch the ball comes first
                    listed[last], listed[touching] = listed[touching], k
                    touching += 1
                last += 1
    return listed, last, Field(value, gx, gy, gz, error)


@njit(cache=True, nogil=True)
def view(clusters, listed, field, q, reach, tolerance, limit):
    """Return what caps cover of the view, to first order around a place.

    Parameters
    ----------
    clusters : Clusters
    listed : array, int64
        Those to look at.
    field : Field
        At q, of all the others.
    q : tuple of 3 floats
    reach : float
        Radius of the ball around q for which the result holds.
    tolerance : float
        Clusters that may leave out more than this are halved.
    limit : float
        Give up once more than this may be left out in all.

    Returns
    -------
    field : Field
        Of all caps at q; its error is infinite where q itself is too near to a cap for
        rounding.
    is_torn : bool
        Whether a cap enters the ball: then the field is right up to whole numbers.
    """
    value, gx, gy, gz, error = field
    is_torn = False
    leaves = len(clusters.start) - 1
    stack = np.empty(DEPTH, np.int64)
    for place in range(len(listed)):
        stack[0], size = listed[place], 1
        while size and error <= limit:
            size -= 1
            k = stack[size]
            r = between(q, clusters.centre[k])
            far = length(r)
            off = left_out(clusters, k, far, reach)
            # Halving clusters helps little once the ball is what makes h large.
            if off <= tolerance or (off < np.inf and clusters.radius[k] < reach / 4):
                v, x, y, z = expansion(clusters, k, r, far)
                value, gx, gy, gz = value + v, gx + x, gy + y, gz + z
                error += off
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
                    may_tear = off == np.inf
                    g, change, cuts = _change(rim, clusters.apex[loop], q, reach, limit, may_tear)
                    gx, gy, gz = gx + g[0], gy + g[1], gz + g[2]
                    error += change
                    is_torn |= cuts
                    if error > limit:
                        break
                share, is_clear = _covered(rim, clusters.apex[loop], q)
                value += share
                if reach == 0 and not is_clear:
                    error = np.inf
    return Field(value, gx, gy, gz, error), is_torn


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
