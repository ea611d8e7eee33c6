"""Straight lines through the body: where a path bends last, and what sees that place.

Dijkstra's order makes seeing cheap. Nodes nearer to the anchor are settled first, so a
lattice point sees the anchor when the neighbour that the line of sight passes next to does.
Where that neighbour follows another anchor, the line itself is walked.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..compiled import lean
from ..graph import CutCellGraph
from ..graph.interior import OUTSIDE, point_number
from .labels import follows_anchor


def body_of(graph: CutCellGraph) -> tuple:
    """Return what kernels ask of a graph.

    That is its resolution, its first lattice point and first crossing, where its nodes are,
    and the lattice points inside with the edges between them.
    """
    firsts = graph.first_point, graph.first_crossing
    return (graph.lattice.resolution, *firsts, graph.nodes, graph.interior.table, graph.whole)


@njit(cache=True, inline="always")
def bend_of(nodes, bones, each, anchor, here):
    """Return the place of an anchor; of a bone, the point nearest to here."""
    if anchor >= 0:
        n = anchor // each
        return nodes[n, 0], nodes[n, 1], nodes[n, 2]
    b = ~anchor
    x, y, z = bones[b, 0], bones[b, 1], bones[b, 2]
    ex, ey, ez, inverse = bones[b, 3], bones[b, 4], bones[b, 5], bones[b, 6]
    along = (here[0] - x) * ex + (here[1] - y) * ey + (here[2] - z) * ez
    t = min(max(along * inverse, 0.0), 1.0)
    return x + t * ex, y + t * ey, z + t * ez


@njit(cache=True, inline="always")
def straight(p, q):
    """Return how far two places are apart."""
    x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return np.sqrt(x * x + y * y + z * z)


@njit(cache=True, inline="always")
def sees(body, anchors, each, u, here, anchor, bend):
    """Tell whether the straight way from the bend to a lattice point stays inside.

    It does from the node u beside that point.
    """
    resolution, first_point, _, _, table, whole = body
    x, y, z = int(here[0] * resolution), int(here[1] * resolution), int(here[2] * resolution)
    dx = bend[0] * resolution - 0.5 - x
    dy = bend[1] * resolution - 0.5 - y
    dz = bend[2] * resolution - 0.5 - z
    far = max(abs(dx), abs(dy), abs(dz))
    if far > 1:
        sx, sy, sz = int(np.rint(dx / far)), int(np.rint(dy / far)), int(np.rint(dz / far))
        w = _point(table, resolution, x + sx, y + sy, z + sz)
        if w != OUTSIDE:
            w += first_point
            if w == u:
                return True
            follows = anchor >= 0 and w == anchor // each
            follows |= follows_anchor(anchors, each, w, anchor)
            # Across a gap thinner than a cell the next point is no neighbour.
            if follows and _walk(table, whole, resolution, (x, y, z), (x + sx, y + sy, z + sz)):
                return True
    cell = int(bend[0] * resolution), int(bend[1] * resolution), int(bend[2] * resolution)
    return _walk(table, whole, resolution, (x, y, z), cell)


@njit(cache=True, inline="always")
def _point(table, resolution, x, y, z):
    if not (0 <= x < resolution and 0 <= y < resolution and 0 <= z < resolution):
        return np.int64(OUTSIDE)
    return point_number(table[0], table[1], table[2], table[3], x * resolution + y, z)


@lean
def _walk(table, whole, resolution, cell, goal):
    """Tell whether the cells along a line are joined by edges inside (Amanatides & Woo 1987)."""
    x, y, z = cell
    dx, dy, dz = abs(goal[0] - x), abs(goal[1] - y), abs(goal[2] - z)
    sx, sy, sz = np.sign(goal[0] - x), np.sign(goal[1] - y), np.sign(goal[2] - z)
    # When the line leaves the cell on either side, as a fraction of the way.
    tx = 0.5 / dx if dx else np.inf
    ty = 0.5 / dy if dy else np.inf
    tz = 0.5 / dz if dz else np.inf
    p = _point(table, resolution, x, y, z)
    for _ in range(dx + dy + dz):
        if tx <= ty and tx <= tz:
            axis, step = 0, sx
            x += sx
            tx += 1 / dx
        elif ty <= tz:
            axis, step = 1, sy
            y += sy
            ty += 1 / dy
        else:
            axis, step = 2, sz
            z += sz
            tz += 1 / dz
        q = _point(table, resolution, x, y, z)
        if q == OUTSIDE or not whole[axis, p if step > 0 else q]:
            return False
        p = q
    return True
