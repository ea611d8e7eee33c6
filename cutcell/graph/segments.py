"""Which pieces of the rays lie inside the body (paper section 3.1, figure "ray segments").

Crossings and lattice points dice each ray into segments; a segment is kept when the
winding number at its midpoint is at least tau. Kept segments that follow one another are
stored as a run, so memory grows with the surface, not with the volume.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..threads import in_threads
from .caps import Caps
from .holes import BLOCK, UNSURE, Needs
from .rays import AXES, STRIPS, Crossings, cast_rays, first_at_least, grown
from .winding import Boundary, boundary_turns

NONE = -1


@dataclass(frozen=True, eq=False)
class Runs:
    """Stretches of kept segments along the rays of one axis, in the order of the rays.

    A run goes from a crossing (or NONE) over the lattice points `first` to `last` to
    another crossing (or NONE). It holds no lattice point when `last` is below `first`.

    Parameters
    ----------
    ray, first, last : arrays, shape (r,), int32
    low, high : arrays, shape (r,), int64
        Indices into the axis' `Crossings`, or -1.
    """

    ray: NDArray[np.int32]
    first: NDArray[np.int32]
    last: NDArray[np.int32]
    low: NDArray[np.int64]
    high: NDArray[np.int64]


def kernels_are_compiled() -> bool:
    """Tell whether this machine has compiled the kernels before, in any process."""
    return any(Path(str(_walk_rays.stats.cache_path)).glob("segments._walk_rays*.nbc"))


def find_runs(
    vertices: NDArray[np.float64],
    crossings: Crossings,
    boundary: Boundary,
    caps: Caps,
    needs: Needs,
    resolution: int,
    axis: int,
    winding_threshold: float,
) -> Runs:
    """Find the kept segments along one axis.

    Parameters
    ----------
    vertices : array, shape (n, 3)
        Unit-cube coordinates.
    crossings : Crossings
        Of the rays along `axis`.
    boundary : Boundary
    caps : Caps
        Of that boundary.
    needs : Needs
        Of those caps.
    resolution, axis : int
    winding_threshold : float
        tau: segments with at least this winding number are kept.
    """
    u, v, along = AXES[axis]
    closing = cast_rays(caps.vertices, caps.faces, resolution, axis)
    weight = closing.sign * caps.count[closing.triangle]
    projected = np.ascontiguousarray(vertices[:, [u, v, along]])
    # The blocks as this family of rays sees them: by u, v, and along.
    seen = [
        np.ascontiguousarray(a)
        for a in (
            needs.coarse.transpose(u, v, along),
            needs.row.transpose(u, v, along),
            needs.fine.transpose(0, u + 1, v + 1, along + 1),
        )
    ]
    lowest, highest = seen[0].min(axis=2), seen[0].max(axis=2)
    calm = np.where((lowest == highest) & (highest < UNSURE), lowest, np.int8(UNSURE))
    turn = -1.0 if axis == 1 else 1.0  # (x, z, y) is left-handed
    inputs = (
        (resolution, winding_threshold, turn, projected, boundary.edges, boundary.count),
        (calm, *seen),
        (crossings.start, crossings.position, crossings.sign),
        (closing.start, closing.position, weight),
    )
    strips = np.linspace(0, resolution**2, STRIPS + 1).astype(np.int64)
    rows = in_threads(lambda k: _walk_rays(*inputs, strips[k], strips[k + 1]), range(STRIPS))
    ray, first, last, low, high = np.concatenate(rows).T
    ray, first, last = (a.astype(np.int32) for a in (ray, first, last))
    return Runs(ray, first, last, low.copy(), high.copy())


@njit(cache=True, nogil=True)
def _walk_rays(surface, needs, crossings, closing, first_ray, last_ray):
    """List the runs of a strip of rays, as rows (ray, first, last, low, high)."""
    resolution = surface[0]
    tau = surface[1]
    rows = np.empty((256, 5), np.int64)
    count = 0
    line = np.empty(resolution, np.int8)
    for r in range(first_ray, last_ray):
        begin, end = crossings[0][r], crossings[0][r + 1]
        chi = 0
        for c in range(begin, end):
            chi += crossings[2][c]
        # Far from holes, no winding number changes between two crossings.
        need = needs[0][r // resolution // BLOCK, r % resolution // BLOCK]
        calm = need < UNSURE and closing[0][r] == closing[0][r + 1]
        if calm and begin == end and chi < need:
            continue
        if not calm:
            _needs_along(needs, r, line)
        passed = closing[0][r]
        lid = 0  # crossings ahead with the caps, counted like chi
        for c in range(passed, closing[0][r + 1]):
            lid += closing[2][c]
        k = 0
        # Gap by gap: from the crossing c - 1 (or the cube's wall) to the crossing c.
        for c in range(begin, end + 1):
            if c > begin:
                chi -= crossings[2][c - 1]
            before = crossings[1][c - 1] if c > begin else 0.0
            after = crossings[1][c] if c < end else 1.0
            beyond = first_at_least(after, resolution) if c < end else resolution
            if calm:
                # From the wall straight to a crossing there is no segment.
                if chi >= need and (beyond > k or begin < c < end):
                    if count == len(rows):
                        rows = grown(rows)
                    rows[count, 0], rows[count, 1], rows[count, 2] = r, k, beyond - 1
                    rows[count, 3] = c - 1 if c > begin else NONE
                    rows[count, 4] = c if c < end else NONE
                    count += 1
                k = beyond
                continue
            # Segment s of the gap ends at lattice point s; the last one at crossing c.
            is_open = False
            for s in range(k, beyond + 1):
                kept = False
                if (s > k or c > begin) and (s < beyond or c < end):  # not to a wall
                    left = before if s == k else (s - 0.5) / resolution
                    right = after if s == beyond else (s + 0.5) / resolution
                    middle = 0.5 * (left + right)
                    while passed < closing[0][r + 1] and closing[1][passed] <= middle:
                        lid -= closing[2][passed]
                        passed += 1
                    need = line[min(int(middle * resolution), resolution - 1)]
                    if need < UNSURE:
                        kept = chi + lid >= need
                    else:
                        kept = chi + _boundary_turns(surface, r, middle) >= tau
                if kept and not is_open:
                    if count == len(rows):
                        rows = grown(rows)
                    rows[count, 0] = r
                    rows[count, 1] = k if s == k else s - 1
                    rows[count, 3] = c - 1 if s == k else NONE
                # A run ends before a dropped segment, and at every crossing: what follows
                # starts from the same node as a run of its own.
                if (is_open and not kept) or (kept and s == beyond):
                    rows[count, 2] = s - 1
                    rows[count, 4] = c if kept else NONE
                    count += 1
                is_open = kept
            k = beyond
    return rows[:count]


@njit(cache=True)
def _needs_along(needs, r, line):
    """Put what each cell along ray r needs into `line`."""
    _, coarse, row, fine = needs
    resolution = len(line)
    i, j = r // resolution, r % resolution
    for k in range(resolution):
        line[k] = coarse[i // BLOCK, j // BLOCK, k // BLOCK]
        if line[k] == UNSURE:
            block = row[i // BLOCK, j // BLOCK, k // BLOCK]
            line[k] = fine[block, i % BLOCK, j % BLOCK, k % BLOCK]


@njit(cache=True)
def _boundary_turns(surface, r, height):
    resolution, _, turn, vertices, edges, count = surface
    pu, pv = (r // resolution + 0.5) / resolution, (r % resolution + 0.5) / resolution
    return turn * boundary_turns(vertices, edges, count, pu, pv, height)
