"""Straight lines through the body: where a path bends last, and what sees that place.

Dijkstra's order makes seeing cheap. Nodes nearer to the anchor are settled first, so a lattice
point sees the anchor when the neighbour that the line of sight passes next to does, or what stands
for that neighbour (`graph.contracted`). Where it follows another anchor, the line itself is walked.
"""

from __future__ import annotations

import numpy as np

from ..compiled import compiled, lean
from ..graph import CutCellGraph
from ..graph.interior import OUTSIDE
from .labels import follows_anchor


def body_of(graph: CutCellGraph) -> tuple:
    """Return what kernels ask of a graph.

    That is its resolution, its first lattice point and first crossing that stays, where nodes that
    stay are; then how to take steps: which lattice points are joined, which node of the graph each
    node that stays is, and the number of each node of the graph (`graph.contracted`).
    """
    left = graph.contracted
    steps = graph.steps, left.node, left.number
    return graph.lattice.resolution, graph.first_point, left.first_crossing, left.places, steps


@compiled(inline="always")
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


@compiled(inline="always")
def straight(p, q):
    """Return how far two places are apart."""
    x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return np.sqrt(x * x + y * y + z * z)


@compiled(inline="always")
def sees(body, anchors, each, u, v, here, anchor, bend):
    """Tell whether the straight way from the bend to the lattice point v stays inside.

    It does from the node u beside that point; `here` is its place.
    """
    resolution, first_point, _, _, (steps, node, number) = body
    x, y, z = int(here[0] * resolution), int(here[1] * resolution), int(here[2] * resolution)
    dx = bend[0] * resolution - 0.5 - x
    dy = bend[1] * resolution - 0.5 - y
    dz = bend[2] * resolution - 0.5 - z
    far = max(abs(dx), abs(dy), abs(dz))
    point = node[v] - first_point
    if far > 1:
        way = np.rint(dx / far), np.rint(dy / far), np.rint(dz / far)
        w = _beside(steps, point, way)
        if far > 2 and w != OUTSIDE and number[first_point + w] == v:  # in the block of v
            w = _beside(steps, w, way)
        if w != OUTSIDE:
            w = number[first_point + w]
            follows = w == u or (anchor >= 0 and w == anchor // each)
            if follows or follows_anchor(anchors, each, w, anchor):
                return True
    x, y, z = (
        int(bend[0] * resolution) - x,
        int(bend[1] * resolution) - y,
        int(bend[2] * resolution) - z,
    )
    return _walk(steps, point, x, y, z)


@compiled(inline="always")
def _beside(steps, point, way):
    """Return the point that a line in some way, -1 to 1 along each axis, passes next to."""
    for axis in range(3):
        point = _step(steps, point, axis, way[axis])
    return point


@compiled(inline="always")
def _step(steps, point, axis, way):
    """Return the point next along an axis, itself if the way is 0; OUTSIDE if none is joined."""
    if point == OUTSIDE or way == 0:
        return point
    return steps[point, axis + 3 * (way < 0)]


@lean
def _walk(steps, point, x, y, z):
    """Tell if cells along a line of (x, y, z) are joined by edges (Amanatides & Woo 1987)."""
    dx, dy, dz = abs(x), abs(y), abs(z)
    # When the line leaves the cell on either side, as a fraction of the way.
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
