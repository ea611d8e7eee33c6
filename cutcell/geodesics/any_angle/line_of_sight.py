"""Line of sight through the body, from a node to the parent vertex of a path (Theta*).

Nodes closer to the parent are settled first. So a lattice point has line of sight to the parent if
the neighbour beside the line, or that neighbour's representative (`contraction.py`), has a label
with the same parent. Otherwise the line is traversed cell by cell.
"""

from __future__ import annotations

import numpy as np

from ...geometry.vectors import TIE
from ...graph import CutCellGraph
from ...graph.interior import OUTSIDE
from ...runtime.compiled import compiled, no_refcount
from .contraction import Contraction
from .labels import SETTLED


def body_of(graph: CutCellGraph, contraction: Contraction) -> tuple:
    """Return the arrays of a contracted graph that kernels need.

    These are the resolution; the first lattice point and surface node that are kept; the positions
    of kept nodes; to step between lattice points, `steps` with the `node` and `number` of the
    contraction; and the axes in the order in which positions are compared.
    """
    steps = contraction.steps, contraction.node, contraction.number
    first = graph.first_point, contraction.first_surface
    axes = tuple(graph.lattice.axes.tolist())
    return graph.lattice.resolution, *first, contraction.places, steps, axes


@compiled(inline="always")
def parent_position(nodes, bones, each, parent, position):
    """Return the position of a parent; of a bone, its point nearest to `position`."""
    if parent >= 0:
        n = parent // each
        return nodes[n, 0], nodes[n, 1], nodes[n, 2]
    b = ~parent
    x, y, z = bones[b, 0], bones[b, 1], bones[b, 2]
    ex, ey, ez, inverse = bones[b, 3], bones[b, 4], bones[b, 5], bones[b, 6]
    along = (position[0] - x) * ex + (position[1] - y) * ey + (position[2] - z) * ez
    t = min(max(along * inverse, 0.0), 1.0)
    return x + t * ex, y + t * ey, z + t * ez


@compiled(inline="always")
def is_preferred(body, bones, labels, each, parent, other, position):
    """Return whether a path bends at this parent, if it is as long as by way of another parent.

    Preferred is the one that is nearer to the bone, then the first by position.
    """
    _, _, _, nodes, _, axes = body
    nearer = labels[other].distance if other >= 0 else 0.0
    nearer -= labels[parent].distance if parent >= 0 else 0.0
    if abs(nearer) > TIE:
        return nearer > 0
    p = parent_position(nodes, bones, each, parent, position)
    q = parent_position(nodes, bones, each, other, position)
    for axis in axes:
        if abs(p[axis] - q[axis]) > TIE:
            return p[axis] < q[axis]
    return abs(parent) < abs(other)


@compiled(inline="always")
def straight(p, q):
    """Return the distance between two points."""
    x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return np.sqrt(x * x + y * y + z * z)


@compiled(inline="always")
def has_line_of_sight(body, labels, parents, each, u, v, position, parent, origin, limit):
    """Return whether the lattice point v, at `position`, has line of sight to a parent at `origin`.

    Its neighbour u has. Settled labels with distances below the limit do not depend on ties.
    """
    resolution, first_point, _, _, (steps, node, number), _ = body
    # From the middle of the cell of v, in cells.
    x = origin[0] * resolution - int(position[0] * resolution) - 0.5
    y = origin[1] * resolution - int(position[1] * resolution) - 0.5
    z = origin[2] * resolution - int(position[2] * resolution) - 0.5
    far = max(abs(x), abs(y), abs(z))
    point = node[v] - first_point
    if far > 1 + TIE:
        half = far * (0.5 + TIE)
        direction = _sign(x, half), _sign(y, half), _sign(z, half)
        w = _neighbour(steps, point, direction)
        if far > 2 + TIE and w != OUTSIDE and number[first_point + w] == v:  # in the block of v
            w = _neighbour(steps, w, direction)
        if w != OUTSIDE:
            w = number[first_point + w]
            if w == u or (parent >= 0 and w == parent // each):
                return True
            for label in range(w * each, w * each + each):
                if parents[label] == parent and labels[label].distance < limit:
                    return labels[label].after == SETTLED or _traverse(steps, point, x, y, z)
    return _traverse(steps, point, x, y, z)


@compiled(inline="always")
def _sign(x, least):
    """Return the sign of x, 0 if its magnitude is not above a limit."""
    return (1 if x > least else 0) - (1 if x < -least else 0)


@compiled(inline="always")
def _neighbour(steps, point, direction):
    """Return the lattice point in a direction of -1, 0 or 1 along each axis.

    OUTSIDE if no order of the axes leads to it.
    """
    x, y, z = direction
    neighbour = _step(steps, _step(steps, _step(steps, point, 0, x), 1, y), 2, z)
    if neighbour == OUTSIDE and abs(x) + abs(y) + abs(z) > 1:
        return _by_another_order(steps, point, x, y, z)
    return neighbour


@no_refcount
def _by_another_order(steps, point, x, y, z):
    direction = x, y, z
    for first in range(3):
        for turn in range(1, 3):
            neighbour = point
            for k in range(3):
                axis = (first + k * turn) % 3
                neighbour = _step(steps, neighbour, axis, direction[axis])
            if neighbour != OUTSIDE:
                return neighbour
    return OUTSIDE


@compiled(inline="always")
def _step(steps, point, axis, direction):
    """Return the neighbour along an axis, OUTSIDE if there is none; the point if direction is 0."""
    if point == OUTSIDE or direction == 0:
        return point
    return steps[point, axis + 3 * (direction < 0)]


@no_refcount
def _traverse(steps, point, x, y, z):
    """Return whether edges join all cells on a line (Amanatides & Woo 1987).

    It runs (x, y, z) cells from the middle of the cell of a lattice point.
    """
    # Where the line next leaves its cell along each axis, as a fraction of its length.
    tx, ty, tz = 0.5 / max(abs(x), TIE), 0.5 / max(abs(y), TIE), 0.5 / max(abs(z), TIE)
    while point != OUTSIDE:
        t = min(tx, ty, tz) + TIE
        if t >= 1:
            return True
        # Through an edge or a corner of the cell it leaves along several.
        direction = _sign(x, 0) * (tx <= t), _sign(y, 0) * (ty <= t), _sign(z, 0) * (tz <= t)
        point = _neighbour(steps, point, direction)
        tx += abs(direction[0] / x) if direction[0] else 0.0
        ty += abs(direction[1] / y) if direction[1] else 0.0
        tz += abs(direction[2] / z) if direction[2] else 0.0
    return False
