"""What all caps cover of the view, near and far, within a proven bound.

Far clusters are expanded, see `clusters.py`. What they cover in a ball around a place q is
a field, see `field.py`.

The caps of loops nearby are summed exactly at q. Their gradient is, by Biot and Savart, the
integral of F x dr around the loop, whichever surface spans it, and its own derivatives at
most that of |DF| = 1 / (2 pi |r|^3). So within s of q a loop leaves out at most

    s^2 / 2 sum over its edges of length / (2 pi d^3),

with d the distance of an edge to the ball. This is so even if the cap runs through the ball,
but for the jump by one where it is passed: such a ball is called torn.
"""

from __future__ import annotations

import numpy as np

from ..compiled import compiled, lean
from .clusters import left_out
from .field import ERROR
from .moments import add_expansion
from .solid_angle import between, cross, distance_to_edge, dot, is_within, length, turning

NEGLIGIBLE = 5e-3
"""What a cluster may leave out in a ball and still be far from all points in it."""
COARSE = 0.3
"""Clusters that leave out more are halved, to see if parts of them are far."""
ENOUGH = 0.5
"""Once more than this may be left out in a ball, its field is of no use."""
SMALL = 1e-60
"""Numbers this small, or their inverse large, are scaled before products leave the floats."""


@lean
def set_apart(clusters, among, far, near, q, reach):
    """Set apart the clusters that are far from a ball.

    Parameters
    ----------
    clusters : Clusters
    among : array, int32
        Clusters that have no cap in common.
    far : array
        A field at q, to which those are added that leave out next to nothing in the ball.
    near : array, int32
        Gets clusters that hold all other caps; as long as there are caps.
    q : tuple of 3 floats
    reach : float
        Radius of the ball around q.

    Returns
    -------
    count : int
        Of near clusters. They are not much smaller than the ball.
    """
    count = 0
    leaves = len(clusters.start) - 1
    for top in among:
        k, end = top, after(top)
        while k != end:
            r, distance, off = _seen(clusters, k, q, reach)
            if off <= NEGLIGIBLE:
                add_expansion(far, clusters.moments[k], r, distance)
                far[ERROR] += off
            elif off > COARSE and clusters.sphere[k, 3] > reach and k < leaves:
                k *= 2
                continue
            else:
                near[count] = k
                count += 1
            k = after(k)
    return count


@lean
def view(clusters, among, field, q, reach, tolerance):
    """Add what caps cover of the view in a ball to a field.

    Parameters
    ----------
    clusters : Clusters
    among : array, int32
        The clusters of these caps.
    field : array
        At q, of anything else; changed.
    q : tuple of 3 floats
    reach : float
        Radius of the ball around q for which the result holds.
    tolerance : float
        Clusters that may leave out more than this are halved.

    Returns
    -------
    is_torn : bool
        Whether a cap enters the ball: then the field is right up to whole numbers.
    """
    is_torn = False
    leaves = len(clusters.start) - 1
    for top in among:
        k, end = top, after(top)
        while k != end:
            r, distance, off = _seen(clusters, k, q, reach)
            # Halving clusters helps little once the ball is what makes h large.
            if off <= tolerance or (off < np.inf and clusters.sphere[k, 3] < reach / 4):
                add_expansion(field, clusters.moments[k], r, distance)
                field[ERROR] += off
            elif k < leaves:
                k *= 2
                continue
            else:
                is_torn |= _add_caps(clusters, k - leaves, field, q, reach, off == np.inf)
            if field[ERROR] > ENOUGH:
                return is_torn
            k = after(k)
    return is_torn


@lean
def _add_caps(clusters, leaf, field, q, reach, may_tear):
    """Add the field of the caps of a cluster that is not halved; tell if one enters the ball."""
    is_torn = False
    for loop in range(clusters.start[leaf], clusters.start[leaf + 1]):
        rim = clusters.rim[clusters.first[loop] : clusters.first[loop + 1]]
        is_torn |= _add_change(field, rim, clusters.apex[loop], q, reach, may_tear)
        if field[ERROR] > ENOUGH:
            break
        field[0] += _turned(rim, clusters.apex[loop], q)
    return is_torn


@compiled(inline="always")
def _seen(clusters, k, q, reach):
    """Return the way to a cluster, how far that is, and what its expansion leaves out."""
    r = between(q, clusters.sphere[k])
    distance = length(r)
    return r, distance, left_out(clusters.sphere[k], distance, reach)


@compiled(inline="always")
def after(k):
    """Return the cluster that follows on k and all that it is made of, 0 after the last."""
    while k & 1:
        k >>= 1
    return k + 1 if k else 0


@lean
def _turned(rim, apex, q):
    """Return what one cap covers of the view.

    Half the solid angle of a triangle is the angle of a complex number (van Oosterom &
    Strackee 1983). Their product (x, y) has the sum of the angles, up to whole turns, which
    are counted: two angles on one side of the real axis pass the far side if their sum does
    not stay there.
    """
    x, y, turns = 1.0, 0.0, 0.0
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
        after = x * triple + y * rest
        x, was = x * rest - y * triple, y
        y = after
        if was >= 0 and triple >= 0 and y < 0:
            turns += 1
        elif was < 0 and triple < 0 and y >= 0:
            turns -= 1
        size = abs(x) + abs(y)
        if 0 < size < SMALL or size > 1 / SMALL:  # else products leave the floats
            x, y = x / size, y / size
        b, lb = a, la
    return turns + np.arctan2(y, x) / (2 * np.pi)


@lean
def _add_change(field, rim, apex, q, reach, may_tear):
    """Add the gradient of what a cap covers, and what that leaves out; tell if it is torn."""
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
                field[ERROR] = np.inf
                return True
        field[ERROR] += reach * reach / 2 * side / (2 * np.pi * gap * gap * gap)
        if field[ERROR] > ENOUGH:
            break
        g = turning(b, a, lb, la)
        field[1] += g[0]
        field[2] += g[1]
        field[3] += g[2]
        if may_tear and not is_torn:
            is_torn = is_within(b, a, c, reach)
    return is_torn
