"""Winding numbers at the midpoints of segments, as exact as `w >= tau` needs them.

On a closed mesh the winding number is the signed count of crossings ahead. Holes are closed by
caps, whose own winding number is subtracted: see `cells.py` for where that takes no query, and
`queries.py` for where it does.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ....runtime.compiled import compiled
from ....runtime.progress import Tell, share_of
from ...rays import AXES, RayHits, cast_all_rays, in_space
from ...segments import NONE, Segments
from ...surface import Surface
from ..exact import boundary_angles
from .caps import smallest_caps
from .cells import BLOCK, CONSTANT, classify_cells
from .clusters import build_tree
from .queries import winding_numbers_of_caps

DECIDED = -1
BITS = BLOCK.bit_length() - 1
"""log2 of BLOCK."""


class TreecodeWindingNumbers:
    """Winding numbers of a surface along its rays that are on the right side of tau.

    Parameters
    ----------
    surface : Surface
    hits : sequence of RayHits
        Along x, y and z.
    winding_threshold : float
        tau.
    report : callable
    """

    def __init__(
        self,
        surface: Surface,
        hits: Sequence[RayHits],
        winding_threshold: float,
        report: Tell = lambda done: None,
    ) -> None:
        self._surface, self._threshold = surface, winding_threshold
        self._crossings = [
            np.append(0.0, np.cumsum(along.sign, dtype=np.float64)) for along in hits
        ]
        self._hits = hits
        if surface.is_closed and winding_threshold > 0:
            return
        caps = smallest_caps(surface.vertices, surface.boundary)
        report(0.1)
        self._cap_hits = cast_all_rays(
            caps.vertices, caps.faces, surface.resolution, share_of(report, 0.1, 0.4)
        )
        self._clusters = build_tree(caps)
        self._classes = classify_cells(
            self._clusters, surface.resolution, winding_threshold, share_of(report, 0.4, 1)
        )

    def in_gaps(self, axis: int) -> NDArray[np.float64] | None:
        """Return the winding number before each hit, (c,), of a closed mesh, see `segments`."""
        if not self._surface.is_closed or self._threshold <= 0:
            return None
        start, crossings = self._hits[axis].start, self._crossings[axis]
        return crossings[start[1:]].repeat(np.diff(start)) - crossings[:-1]

    def beyond_hits(self, axis: int) -> NDArray[np.int32]:
        """Return which lattice points may be inside before a ray's first hit or beyond its last."""
        resolution, coarse = self._surface.resolution, self._classes.coarse
        may_be_inside = np.moveaxis((coarse >= 0) | (coarse <= CONSTANT), AXES[axis][2], 2)
        first = BLOCK * may_be_inside.argmax(axis=2)
        last = BLOCK * (len(coarse) - may_be_inside[..., ::-1].argmax(axis=2))
        is_outside = ~may_be_inside.any(axis=2)
        first[is_outside], last[is_outside] = resolution, NONE
        ends = np.stack([first, last], axis=2).astype(np.int32)
        points = ends.repeat(BLOCK, axis=0)[:resolution].repeat(BLOCK, axis=1)[:, :resolution]
        points = points.reshape(-1, 2)
        points[np.flatnonzero(np.diff(self._cap_hits[axis].start))] = 0, resolution
        return points

    def at_midpoints(self, segments: Segments) -> NDArray[np.float64]:
        """Return numbers, shape (s,), that are at least tau exactly where the winding number is.

        Where no query is needed, it is rounded down to tau plus a whole number.
        """
        axis, ray, gap = segments.axis, segments.ray, segments.gap
        start, crossings = self._hits[axis].start, self._crossings[axis]
        caps = self._cap_hits[axis]
        w, row = _by_class(
            (axis, segments.resolution, ray, gap, segments.middle),
            (start, crossings),
            (caps.start, caps.position, caps.sign),
            self._classes.coarse,
            self._classes.fine,
            self._threshold,
        )
        query = np.flatnonzero(row != DECIDED)
        margin = w[query] - self._threshold
        w[query] -= winding_numbers_of_caps(
            self._classes.expansions, self._clusters, row[query], segments.midpoints(query), margin
        )
        left = query[np.isnan(w[query])]
        if len(left):
            ahead = crossings[start[ray[left] + 1]] - crossings[gap[left]]
            # Between the hits of repeated faces many midpoints are at one place.
            points, index = np.unique(segments.midpoints(left), axis=0, return_inverse=True)
            w[left] = ahead + self._boundary_angles(axis, points)[index]
        return w

    def _boundary_angles(self, axis: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the winding numbers at points (q, 3) less the crossings ahead, exactly."""
        order = list(AXES[axis])
        vertices = np.ascontiguousarray(self._surface.vertices[:, order])
        angles = boundary_angles(vertices, self._surface.boundary, points[:, order])
        return -angles if axis == 1 else angles  # (x, z, y) is left-handed


@compiled
def _by_class(segments, hits, cap_hits, coarse, fine, tau):
    """Return winding numbers where the class of the cell decides, and the rows of expansions.

    Where there is a query, the row is not DECIDED and the number is that of the capped mesh.
    """
    axis, resolution, ray, gap, middle = segments
    end, crossings = hits
    start, position, sign = cap_hits
    w, row = np.empty(len(ray)), np.empty(len(ray), np.int32)
    i = j = cap = last_cap = 0
    total = 0.0
    for s in range(len(ray)):
        r = ray[s]
        if s == 0 or r != ray[s - 1]:
            i, j = r // resolution, r % resolution
            cap, last_cap, total = start[r], start[r + 1], crossings[end[r + 1]]
            for c in range(cap, last_cap):
                total += sign[c]
        while cap < last_cap and position[cap] <= middle[s]:
            total -= sign[cap]
            cap += 1
        cell = min(int(middle[s] * resolution), resolution - 1)
        x, y, z = in_space(axis, i, j, cell)
        cell_class = coarse[x >> BITS, y >> BITS, z >> BITS]
        if cell_class >= 0:
            cell_class = fine[cell_class, x % BLOCK, y % BLOCK, z % BLOCK]
        ahead = total - crossings[gap[s]]
        if cell_class < 0:
            w[s], row[s] = tau + (ahead + CONSTANT - cell_class), DECIDED
        else:
            w[s], row[s] = ahead, cell_class
    return w, row
