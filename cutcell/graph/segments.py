"""Which pieces of the rays lie inside the body (paper section 3.1, figure "ray segments").

Crossings and lattice points dice each ray into segments; a segment is kept when the
winding number at its midpoint is at least tau. Kept segments that follow one another are
stored as a run, so memory grows with the surface, not with the volume.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from .caps import Caps
from .rays import AXES, Crossings, cast_rays
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


def find_runs(
    vertices: NDArray[np.float64],
    crossings: Crossings,
    boundary: Boundary,
    caps: Caps,
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
    resolution, axis : int
    winding_threshold : float
        tau: segments with at least this winding number are kept.
    """
    u, v, along = AXES[axis]
    closing = cast_rays(caps.vertices, caps.faces, resolution, axis)
    weight = closing.sign * caps.count[closing.triangle]
    projected = np.ascontiguousarray(vertices[:, [u, v, along]])
    spheres = (np.ascontiguousarray(caps.centre[:, [u, v, along]]), caps.radius, caps.area)
    turn = -1.0 if axis == 1 else 1.0
    inputs = (
        (resolution, winding_threshold, turn, projected, boundary.edges, boundary.count),
        spheres,
        (crossings.start, crossings.position, crossings.sign),
        (closing.start, closing.position, weight),
    )
    counts = np.zeros(resolution**2 + 1, np.int64)
    nothing = np.empty(0, np.int32), np.empty(0, np.int64)
    _walk_rays(*inputs, False, counts[1:], *nothing[:1] * 3, *nothing[1:] * 2)
    start = np.cumsum(counts)
    ray, first, last = (np.empty(start[-1], np.int32) for _ in range(3))
    low, high = (np.empty(start[-1], np.int64) for _ in range(2))
    _walk_rays(*inputs, True, start[:-1].copy(), ray, first, last, low, high)
    return Runs(ray, first, last, low, high)


@njit(cache=True, parallel=True)
def _walk_rays(surface, spheres, crossings, closing, store, cursor, ray, first, last, low, high):
    """Count the runs of each ray in `cursor`; or store them there, moving it on."""
    resolution = surface[0]
    for r in prange(resolution * resolution):
        begin, end = crossings[0][r], crossings[0][r + 1]
        closed = len(spheres[1]) == 0
        if closed and begin == end:
            continue
        chi = 0
        for c in range(begin, end):
            chi += crossings[2][c]
        open_low, open_first, is_open = NONE, 0, False
        k = 0
        # Gap by gap: from the crossing c - 1 (or the cube's wall) to the crossing c.
        for c in range(begin, end + 1):
            if c > begin:
                chi -= crossings[2][c - 1]
            before = crossings[1][c - 1] if c > begin else 0.0
            after = crossings[1][c] if c < end else 1.0
            beyond = k  # the first lattice point that is not in the gap
            if c < end:
                while beyond < resolution and (beyond + 0.5) / resolution < after:
                    beyond += 1
            else:
                beyond = resolution
            # Segments of the gap: s ends at lattice point s; s = beyond ends at crossing c.
            for s in range(k, beyond + 1):
                left = before if s == k else (s - 0.5) / resolution
                right = after if s == beyond else (s + 0.5) / resolution
                from_wall = s == k and c == begin
                to_wall = s == beyond and c == end
                kept = False
                if not (from_wall or to_wall):
                    kept = _is_inside(surface, spheres, closing, r, chi, 0.5 * (left + right))
                if kept and not is_open:
                    is_open = True
                    open_low = c - 1 if s == k else NONE
                    open_first = k if s == k else s - 1
                # A run ends before a dropped segment, and at every crossing: what follows
                # starts from the same node as a run of its own.
                if is_open and (not kept or s == beyond):
                    if store:
                        n = cursor[r]
                        ray[n], low[n], first[n] = r, open_low, open_first
                        high[n] = c if kept else NONE
                        last[n] = s - 1
                    cursor[r] += 1
                    is_open = False
            k = beyond


@njit(cache=True)
def _is_inside(surface, spheres, closing, r, chi, height):
    """Tell whether the winding number at a height on ray r is at least tau.

    chi counts the mesh's own crossings ahead.
    """
    resolution, tau, turn, vertices, edges, count = surface
    centre, radius, area = spheres
    if len(radius) == 0:
        return chi >= tau
    pu = (r // resolution + 0.5) / resolution
    pv = (r % resolution + 0.5) / resolution
    capped = chi
    for c in range(closing[0][r + 1] - 1, closing[0][r] - 1, -1):
        if closing[1][c] <= height:
            break
        capped += closing[2][c]
    # A fan of area A whose points are all at least d away covers at most A / d^2 of the
    # sphere's 4 pi: seen from p, each piece of it shrinks by cos / distance^2 <= 1 / d^2.
    margin = abs(capped - tau)
    error = 0.0
    for k in range(len(radius)):
        du, dv, dw = centre[k, 0] - pu, centre[k, 1] - pv, centre[k, 2] - height
        distance = np.sqrt(du * du + dv * dv + dw * dw) - radius[k]
        if distance <= 0:
            error = np.inf
            break
        error += area[k] / (4 * np.pi * distance * distance)
        if error >= margin:
            break
    if error < margin:
        return capped >= tau
    return chi + turn * boundary_turns(vertices, edges, count, pu, pv, height) >= tau
