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
    """Return which of two equally good parents to take: nearer to the bone, then by position."""
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
        direction = x * (abs(x) > half), y * (abs(y) > half), z * (abs(z) > half)
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
def _neighbour(steps, point, direction):
    """Return the lattice point a step along each axis; OUTSIDE if no order of steps leads to it."""
    x, y, z = direction
    neighbour = _step(steps, _step(steps, _step(steps, point, 0, x), 1, y), 2, z)
    return neighbour if neighbour != OUTSIDE else _by_another_order(steps, point, direction)


@no_refcount
def _by_another_order(steps, point, direction):
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
    """Return whether edges join all cells on the line of (x, y, z) cells from a lattice point.

    Amanatides & Woo 1987.
    """
    dx, dy, dz = max(abs(x), TIE), max(abs(y), TIE), max(abs(z), TIE)
    # Where the line next leaves its cell along each axis, as a fraction of its length.
    ex, ey, ez = 1 / dx, 1 / dy, 1 / dz
    tx, ty, tz = 0.5 * ex, 0.5 * ey, 0.5 * ez
    along_x, along_y, along_z = 3 * (x < 0), 1 + 3 * (y < 0), 2 + 3 * (z < 0)  # columns of `steps`
    while point != OUTSIDE:
        t = min(tx, ty, tz) + TIE
        if t >= 1:
            return True
        by_x, by_y, by_z = tx <= t, ty <= t, tz <= t
        if by_x + by_y + by_z == 1:
            point = steps[point, by_x * along_x + by_y * along_y + by_z * along_z]
        else:  # through an edge or a corner of the cell it leaves along several
            point = _neighbour(steps, point, (x * by_x, y * by_y, z * by_z))
        tx, ty, tz = tx + by_x * ex, ty + by_y * ey, tz + by_z * ez
    return False
