"""Winding numbers at the midpoints of segments, as exact as `w >= tau` needs them.

On a closed mesh the winding number w is chi, the signed count of crossings ahead. Holes are closed
by caps: w = chi - w_caps, and `queries.py` computes w_caps. Where required = ceil(tau + w_caps) is
the same in all of a cell (`cells.py`), no query is needed for

    floored_w = tau + floor(w - tau) = tau + chi - required,

which is at least tau exactly where w is.
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
from .cells import BLOCK_CELLS, CONSTANT, classify_cells
from .clusters import build_tree
from .queries import winding_numbers_of_caps

DECIDED = -1
BITS = BLOCK_CELLS.bit_length() - 1
"""log2 of BLOCK_CELLS."""


class TreecodeWindingNumbers:
    """Winding numbers of a surface along its rays that are on the right side of tau.

    Parameters
    ----------
    surface : Surface
    hits : sequence of RayHits
        Along x, y and z.
    tau : float
        The winding threshold.
    report : callable
    """

    def __init__(
        self,
        surface: Surface,
        hits: Sequence[RayHits],
        tau: float,
        report: Tell = lambda done: None,
    ) -> None:
        self._surface, self._tau = surface, tau
        self._crossings = [
            np.append(0.0, np.cumsum(along.sign, dtype=np.float64)) for along in hits
        ]
        self._hits = hits
        if surface.is_closed and tau > 0:
            return
        caps = smallest_caps(surface.vertices, surface.boundary)
        report(0.1)
        self._cap_hits = cast_all_rays(
            caps.vertices, caps.faces, surface.resolution, share_of(report, 0.1, 0.4)
        )
        self._clusters = build_tree(caps)
        self._classes = classify_cells(
            self._clusters, surface.resolution, tau, share_of(report, 0.4, 1)
        )

    def in_gaps(self, axis: int) -> NDArray[np.float64] | None:
        """Return the winding number before each hit, (c,), of a closed mesh, see `segments`."""
        if not self._surface.is_closed or self._tau <= 0:
            return None
        start, crossings = self._hits[axis].start, self._crossings[axis]
        return crossings[start[1:]].repeat(np.diff(start)) - crossings[:-1]

    def beyond_hits(self, axis: int) -> NDArray[np.int32]:
        """Return which lattice points may be inside before a ray's first hit or beyond its last."""
        resolution, coarse = self._surface.resolution, self._classes.coarse
        may_be_inside = np.moveaxis((coarse >= 0) | (coarse <= CONSTANT), AXES[axis][2], 2)
        first = BLOCK_CELLS * may_be_inside.argmax(axis=2)
        last = BLOCK_CELLS * (len(coarse) - may_be_inside[..., ::-1].argmax(axis=2))
        is_outside = ~may_be_inside.any(axis=2)
        first[is_outside], last[is_outside] = resolution, NONE
        ends = np.stack([first, last], axis=2).astype(np.int32)
        points = ends.repeat(BLOCK_CELLS, axis=0)[:resolution].repeat(BLOCK_CELLS, axis=1)[
            :, :resolution
        ]
        points = points.reshape(-1, 2)
        points[np.flatnonzero(np.diff(self._cap_hits[axis].start))] = 0, resolution
        return points

    def at_midpoints(self, segments: Segments) -> NDArray[np.float64]:
        """Return floored_w where no query is needed, else w; shape (s,)."""
        axis, ray, gap = segments.axis, segments.ray, segments.gap
        start, crossings = self._hits[axis].start, self._crossings[axis]
        caps = self._cap_hits[axis]
        floored_w, row = _by_class(
            (axis, segments.resolution, ray, gap, segments.middle),
            (start, crossings),
            (caps.start, caps.position, caps.sign),
            self._classes.coarse,
            self._classes.fine,
            self._tau,
        )
        query = np.flatnonzero(row != DECIDED)
        chi = floored_w[query]
        w = chi - winding_numbers_of_caps(
            self._classes.expansions,
            self._clusters,
            row[query],
            segments.midpoints(query),
            chi - self._tau,
        )
        floored_w[query] = w
        left = query[np.isnan(w)]
        if len(left):
            ahead = crossings[start[ray[left] + 1]] - crossings[gap[left]]
            # Between the hits of repeated faces many midpoints are at one place.
            points, index = np.unique(segments.midpoints(left), axis=0, return_inverse=True)
            floored_w[left] = ahead + self._boundary_angles(axis, points)[index]
        return floored_w

    def _boundary_angles(self, axis: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the winding numbers at points (q, 3) less the crossings ahead, exactly."""
        order = list(AXES[axis])
        vertices = np.ascontiguousarray(self._surface.vertices[:, order])
        angles = boundary_angles(vertices, self._surface.boundary, points[:, order])
        return -angles if axis == 1 else angles  # (x, z, y) is left-handed


@compiled
def _by_class(segments, hits, cap_hits, coarse, fine, tau):
    """Return floored_w where the class of the cell decides, and the rows of expansions.

    Where there is a query, the row is not DECIDED and the number is chi.
    """
    axis, resolution, ray, gap, middle = segments
    end, crossings = hits
    start, position, sign = cap_hits
    floored_w, row = np.empty(len(ray)), np.empty(len(ray), np.int32)
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
            cell_class = fine[cell_class, x % BLOCK_CELLS, y % BLOCK_CELLS, z % BLOCK_CELLS]
        chi = total - crossings[gap[s]]
        if cell_class < 0:
            required = cell_class - CONSTANT
            floored_w[s], row[s] = tau + (chi - required), DECIDED
        else:
            floored_w[s], row[s] = chi, cell_class
    return floored_w, row
