"""Inside intervals of the rays, without a list of their segments.

The result is that of `graph/segments.py`, the plain version, with exact winding numbers.

On a closed mesh the winding number is the signed count of crossings ahead. Holes are closed by
caps, whose own winding number is subtracted: see `cells.py` for where that takes no query, and
`queries.py` for where it does. Rays are traversed twice, to list the queries and with their
results; strips of rays through constant cells only once.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ....runtime.progress import Tell, share_of
from ....runtime.threads import in_threads
from ...rays import AXES, RayHits, cast_all_rays, strip_bounds
from ...segments import InsideIntervals
from ...surface import Surface
from .caps import smallest_caps
from .cells import AMBIGUOUS, CONSTANT, classify_cells
from .clusters import ROOT, build_tree
from .queries import query_points
from .strips import keep_strip

MAX_QUERIES = 2**21
"""Queries that are evaluated together, at 140 bytes each at the peak."""


def treecode_intervals(
    surface: Surface,
    hits: Sequence[RayHits],
    winding_threshold: float,
    report: Tell = lambda done: None,
) -> list[InsideIntervals]:
    """Find the intervals that `segments.inside_intervals` finds by exact winding numbers."""
    vertices, boundary, resolution = surface.vertices, surface.boundary, surface.resolution
    caps = smallest_caps(vertices, boundary)
    report(0.05)
    cap_hits = cast_all_rays(caps.vertices, caps.faces, resolution, share_of(report, 0.05, 0.15))
    clusters = build_tree(caps)
    classes = classify_cells(clusters, resolution, winding_threshold, share_of(report, 0.15, 0.3))
    shared = resolution, winding_threshold, classes, boundary, clusters, np.array([ROOT], np.int32)
    families = []
    for axis, (u, v, along) in enumerate(AXES):
        projected = np.ascontiguousarray(vertices[:, [u, v, along]])
        both = tuple((h.start, h.position, h.sign) for h in (hits[axis], cap_hits[axis]))
        families.append((axis, projected, _constant_columns(classes.coarse, along), *both))
    hit_count = sum(len(h.position) for h in hits)
    strips = strip_bounds(resolution, 3 * resolution**3 + hit_count)
    work = [(rays, i * resolution, j * resolution) for rays in families for i, j in strips]
    ambiguous = np.count_nonzero(classes.fine >= 0)
    expected = 3 * ambiguous + hit_count if ambiguous else 0
    rows = _rows_of_strips(shared, work, expected, share_of(report, 0.3, 1))
    count = len(strips)
    of_axes = [np.concatenate(rows[count * k : count * (k + 1)]) for k in range(3)]
    return [InsideIntervals(*np.ascontiguousarray(of_axis.T)) for of_axis in of_axes]


def _rows_of_strips(shared, work, expected, report):
    """Return the intervals of each strip of rays, as rows.

    Strips are processed in groups, and their queries are evaluated as soon as there are many, to
    limit their memory. `expected` is the maximum number of queries in all strips.
    """
    intervals, listed = [], []
    step = max(1, min(len(work), MAX_QUERIES * len(work) // max(expected, 1)))
    for first in range(0, len(work), step):
        strips = work[first : first + step]
        part = share_of(report, first / len(work), (first + len(strips)) / len(work))
        listed += in_threads(
            lambda strip: (strip, *keep_strip(shared, strip)), strips, share_of(part, 0, 0.3)
        )
        is_last = first + step >= len(work)
        if is_last or sum(len(queries) for *_, queries, _ in listed) >= MAX_QUERIES:
            intervals += _evaluate_queries(shared, listed, share_of(part, 0.3, 1))
            listed = []
    return intervals


def _evaluate_queries(shared, listed, report):
    """Return the intervals of strips whose queries are listed."""
    intervals = [rows for _, rows, *_ in listed]
    again = [k for k, (*_, is_undecided) in enumerate(listed) if is_undecided]
    if not again:
        return intervals
    row, queries = (np.concatenate([listed[k][column] for k in again]) for column in (2, 3))
    ends = np.cumsum([len(listed[k][2]) for k in again])
    _, _, classes, _, clusters, _ = shared
    results = query_points(classes.expansions, clusters, row, queries, share_of(report, 0, 0.85))
    decided = in_threads(
        lambda part: keep_strip(shared, listed[part[0]][0], part[1])[0],
        zip(again, np.split(results, ends[:-1]), strict=True),
        share_of(report, 0.85, 1),
    )
    for k, rows in zip(again, decided, strict=True):
        intervals[k] = rows
    return intervals


def _constant_columns(coarse: NDArray[np.int32], along: int) -> NDArray[np.int32]:
    """Return the required crossing count of each column of blocks, or AMBIGUOUS."""
    least = coarse.min(axis=along)
    is_constant = (least == coarse.max(axis=along)) & (least < 0)
    return np.where(is_constant, least - CONSTANT, AMBIGUOUS).astype(np.int32)
