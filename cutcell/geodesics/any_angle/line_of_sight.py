"""Line of sight through the body, from a node to the parent vertex of a path (Theta*).

Nodes closer to the parent are settled first. So a lattice point has line of sight to the parent if
the neighbour beside the line, or that neighbour's representative (`contraction.py`), has a label
with the same parent. Otherwise the line is traversed cell by cell.
"""

from __future__ import annotations

import numpy as np

from ...graph import CutCellGraph
from ...graph.interior import OUTSIDE
from ...runtime.compiled import compiled, no_refcount
from .contraction import Contraction
from .labels import has_parent


def body_of(graph: CutCellGraph, contraction: Contraction) -> tuple:
    """Return the arrays of a contracted graph that kernels need.

    These are the resolution; the first lattice point and surface node that are kept; the positions
    of kept nodes; and, to step between lattice points, `steps` with the `node` and
    `number` of the contraction.
    """
    steps = contraction.steps, contraction.node, contraction.number
    first = graph.first_point, contraction.first_surface
    return graph.lattice.resolution, *first, contraction.places, steps


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
def straight(p, q):
    """Return the distance between two points."""
    x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return np.sqrt(x * x + y * y + z * z)


@compiled(inline="always")
def has_line_of_sight(body, parents, each, u, v, position, parent, origin):
    """Return whether the lattice point v, at `position`, has line of sight to a parent at `origin`.

    Its neighbour u has.
    """
    resolution, first_point, _, _, (steps, node, number) = body
    x, y, z = (
        int(position[0] * resolution),
        int(position[1] * resolution),
        int(position[2] * resolution),
    )
    dx = origin[0] * resolution - 0.5 - x
    dy = origin[1] * resolution - 0.5 - y
    dz = origin[2] * resolution - 0.5 - z
    far = max(abs(dx), abs(dy), abs(dz))
    point = node[v] - first_point
    if far > 1:
        direction = np.rint(dx / far), np.rint(dy / far), np.rint(dz / far)
        w = _neighbour(steps, point, direction)
        if far > 2 and w != OUTSIDE and number[first_point + w] == v:  # in the block of v
            w = _neighbour(steps, w, direction)
        if w != OUTSIDE:
            w = number[first_point + w]
            sees = w == u or (parent >= 0 and w == parent // each)
            if sees or has_parent(parents, each, w, parent):
                return True
    x, y, z = (
        int(origin[0] * resolution) - x,
        int(origin[1] * resolution) - y,
        int(origin[2] * resolution) - z,
    )
    return _traverse(steps, point, x, y, z)


@compiled(inline="always")
def _neighbour(steps, point, direction):
    """Return the lattice point in a direction of -1, 0 or 1 along each axis."""
    for axis in range(3):
        point = _step(steps, point, axis, direction[axis])
    return point


@compiled(inline="always")
def _step(steps, point, axis, direction):
    """Return the neighbour along an axis, OUTSIDE if there is none; the point if direction is 0."""
    if point == OUTSIDE or direction == 0:
        return point
    return steps[point, axis + 3 * (direction < 0)]


@no_refcount
def _traverse(steps, point, x, y, z):
    """Return whether edges join all cells on a line of (x, y, z) cells (Amanatides & Woo 1987)."""
    dx, dy, dz = abs(x), abs(y), abs(z)
    # Where the line next leaves its cell along each axis, as a fraction of its length.
    tx = 0.5 / dx if dx else np.inf
    ty = 0.5 / dy if dy else np.inf
    tz = 0.5 / dz if dz else np.inf
    for _ in range(dx + dy + dz):
        if tx <= ty and tx <= tz:
            point = _step(steps, point, 0, x)
            tx += 1 / dx
        elif ty <= tz:
            point = _step(steps, point, 1, y)
            ty += 1 / dy
        else:
            point = _step(steps, point, 2, z)
            tz += 1 / dz
        if point == OUTSIDE:
            return False
    return True
