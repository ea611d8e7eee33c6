"""Inside intervals of the rays (paper section 3.1, algorithm 1 and figure "ray segments").

Ray hits and lattice points divide each ray into segments. A segment is kept if the winding number
at its midpoint is at least tau. Consecutive kept segments form an interval, so memory grows with
the surface, not with the volume.

On a closed mesh the winding number is the signed count of crossings ahead. Holes are closed by
caps, whose own winding number is subtracted: see `cells.py` for where that takes no query, and
`queries.py` for where it does. Rays are traversed twice, to list the queries and with their
results; strips of rays through constant cells only once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...runtime.progress import Tell, share_of
from ...runtime.threads import in_threads
from ..rays import AXES, RayHits, cast_all_rays, strip_bounds
from .boundary import Boundary
from .segments import keep_strip
from .treecode.caps import smallest_caps
from .treecode.cells import AMBIGUOUS, CONSTANT, classify_cells
from .treecode.clusters import ROOT, build_tree
from .treecode.queries import query_points

MAX_QUERIES = 2**21
"""Queries that are answered together once there are as many. Each takes 140 bytes at the peak."""


@dataclass(frozen=True, eq=False)
class InsideIntervals:
    """Maximal intervals of kept segments on the rays of one axis, in the order of the rays.

    An interval runs from a hit (or NONE) over the lattice points `first` to `last` to the next hit
    (or NONE). It holds no lattice point if `last` is below `first`.

    Parameters
    ----------
    ray, first, last, low, high : arrays, shape (r,), int32
        `low` and `high` are indices into the axis' `RayHits`, or -1.
    """

    ray: NDArray[np.int32]
    first: NDArray[np.int32]
    last: NDArray[np.int32]
    low: NDArray[np.int32]
    high: NDArray[np.int32]


def inside_intervals(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    hits: Sequence[RayHits],
    boundary: Boundary,
    resolution: int,
    winding_threshold: float,
    tell: Tell = lambda done: None,
) -> list[InsideIntervals]:
    """Find the kept segments of the rays along x, y and z.

    Parameters
    ----------
    vertices : array, shape (n, 3), float64
        Unit-cube coordinates.
    faces : array, shape (m, 3), int32
    hits : sequence of RayHits
        Of the rays along x, y and z.
    boundary : Boundary
        Of the mesh.
    resolution : int
    winding_threshold : float
        tau: segments with at least this winding number are kept.
    tell : callable
        See `progress.Tell`.
    """
    caps = smallest_caps(vertices, boundary)
    tell(0.05)
    cap_hits = cast_all_rays(caps.vertices, caps.faces, resolution, share_of(tell, 0.05, 0.15))
    clusters = build_tree(caps)
    classes = classify_cells(clusters, resolution, winding_threshold, share_of(tell, 0.15, 0.3))
    shared = resolution, winding_threshold, classes, boundary, clusters, np.array([ROOT], np.int32)
    families = []
    for axis, (u, v, along) in enumerate(AXES):
        projected = np.ascontiguousarray(vertices[:, [u, v, along]])
        found = tuple((h.start, h.position, h.sign) for h in (hits[axis], cap_hits[axis]))
        families.append((axis, projected, _constant_columns(classes.coarse, along), *found))
    surface = sum(len(h.position) for h in hits)
    strips = strip_bounds(resolution, 3 * resolution**3 + surface)
    work = [(rays, i * resolution, j * resolution) for rays in families for i, j in strips]
    ambiguous = np.count_nonzero(classes.fine >= 0)
    expected = 3 * ambiguous + surface if ambiguous else 0
    rows = _rows_of_strips(shared, work, expected, share_of(tell, 0.3, 1))
    count = len(strips)
    of_axes = [np.concatenate(rows[count * k : count * (k + 1)]) for k in range(3)]
    return [InsideIntervals(*np.ascontiguousarray(of_axis.T)) for of_axis in of_axes]


def _rows_of_strips(shared, work, expected, tell):
    """Return the intervals of each strip of rays, as rows.

    Strips are listed some at a time, and their queries are answered as soon as there are many. This
    bounds the memory that they take. `expected` is how many there are at most in all strips.
    """
    intervals, listed = [], []
    step = max(1, min(len(work), MAX_QUERIES * len(work) // max(expected, 1)))
    for first in range(0, len(work), step):
        strips = work[first : first + step]
        part = share_of(tell, first / len(work), (first + len(strips)) / len(work))
        listed += in_threads(
            lambda strip: (strip, *keep_strip(shared, strip)), strips, share_of(part, 0, 0.3)
        )
        is_last = first + step >= len(work)
        if is_last or sum(len(queries) for *_, queries, _ in listed) >= MAX_QUERIES:
            intervals += _answered(shared, listed, share_of(part, 0.3, 1))
            listed = []
    return intervals


def _answered(shared, listed, tell):
    """Return the intervals of strips whose queries are listed."""
    intervals = [rows for _, rows, *_ in listed]
    again = [k for k, (*_, is_undecided) in enumerate(listed) if is_undecided]
    if not again:
        return intervals
    row, queries = (np.concatenate([listed[k][column] for k in again]) for column in (2, 3))
    ends = np.cumsum([len(listed[k][2]) for k in again])
    _, _, classes, _, clusters, _ = shared
    results = query_points(classes.expansions, clusters, row, queries, share_of(tell, 0, 0.85))
    decided = in_threads(
        lambda part: keep_strip(shared, listed[part[0]][0], part[1])[0],
        zip(again, np.split(results, ends[:-1]), strict=True),
        share_of(tell, 0.85, 1),
    )
    for k, rows in zip(again, decided, strict=True):
        intervals[k] = rows
    return intervals


def _constant_columns(coarse: NDArray[np.int32], along: int) -> NDArray[np.int32]:
    """Return the required crossing count of each column of blocks, or AMBIGUOUS."""
    least = coarse.min(axis=along)
    is_constant = (least == coarse.max(axis=along)) & (least < 0)
    return np.where(is_constant, least - CONSTANT, AMBIGUOUS).astype(np.int32)
