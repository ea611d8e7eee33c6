"""Selection of the segments of a strip of rays: `graph/segments.py`, fused with the treecode."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....runtime.compiled import compiled, no_refcount
from ...rays import first_at_least, in_space
from ...segments import NONE
from ..exact import boundary_angle
from .cells import AMBIGUOUS, BLOCK, CONSTANT, class_at, required_crossings
from .expansion import value_at
from .queries import FIRST, INSIDE, SLACK, UNDECIDED
from .solid_angles import CLEAR, VALUE, WORKSPACE, Y, Z, caps_winding_numbers

NO_RESULTS = np.zeros(0, np.uint8)


def keep_strip(shared, strip, results=None):
    """Run algorithm 1 on a strip of rays; list the queries where there are no results yet.

    Returns the rows of the intervals; the row of the expansions of each query; the queries; and
    whether any segment is undecided.
    """
    rays, ray, last_ray = strip
    resolution, start = shared[0], rays[3][0]
    rows = np.empty((2 * int(start[last_ray] - start[ray] + resolution + 1), 5), np.int32)
    row, queries = np.empty(256, np.int32), np.empty((256, SLACK + 1))
    points, filled = np.empty(WORKSPACE), (0, 0, 0)
    listing = results is None
    arguments = shared, rays, last_ray, NO_RESULTS if listing else results, listing
    while ray < last_ray:
        ray, filled = _keep_segments(*arguments, ray, filled, rows, row, queries, points)
        if ray == last_ray:
            break
        segments = int(start[ray + 1] - start[ray]) + resolution + 1
        if filled[0] + 2 * segments > len(rows):
            rows = _doubled(rows)
        if filled[1] + segments > len(row):
            row, queries = _doubled(row), _doubled(queries)
    return rows[: filled[0]], row[: filled[1]], queries[: filled[1]], filled[2] > 0


def _doubled(array: NDArray) -> NDArray:
    """Return a copy with twice the capacity."""
    larger = np.empty((2 * len(array), *array.shape[1:]), array.dtype)
    larger[: len(array)] = array
    return larger


@no_refcount
def _keep_segments(
    shared, rays, last_ray, results, listing, first_ray, filled, rows, row, queries, points
):
    """Run algorithm 1 on rays until the buffers are full.

    Writes the intervals as `rows` (ray, first, last, low, high). When `listing` it has no results
    yet and lists the queries: the row of the expansions, and what `query_points` takes. `points`
    is a workspace.
    """
    resolution, tau, classes, boundary = shared[:4]
    expansions = classes.expansions
    axis, _, constant, (start, position, sign), (cap_start, cap_position, cap_sign) = rays
    count, query, undecided = filled
    for r in range(first_ray, last_ray):
        begin, end, cap, last_cap = start[r], start[r + 1], cap_start[r], cap_start[r + 1]
        i, j = r // resolution, r % resolution
        required = constant[i // BLOCK, j // BLOCK]
        is_constant = required < AMBIGUOUS and cap == last_cap
        if is_constant and begin == end and required > 0:
            continue  # the ray misses the body
        segments = resolution + end - begin + 1
        is_full = count + 2 * segments > len(rows)
        if is_full or (listing and query + segments > len(row)):
            return r, (count, query, undecided)
        crossings = _signed_count(sign, begin, end)
        cap_crossings = _signed_count(cap_sign, cap, last_cap)
        # The last block crossed by caps on this ray, and its whole number.
        crossed, offset = np.int32(NONE), np.int64(0)
        k = 0
        # Between two hits, c - 1 (or the wall of the cube) and c, segments end at lattice points:
        # segment s at point s, the last one at hit c.
        for c in range(begin, end + 1):
            crossings -= sign[c - 1] if c > begin else 0
            before = position[c - 1] if c > begin else 0.0
            after = position[c] if c < end else 1.0
            beyond = first_at_least(after, resolution) if c < end else resolution
            s, is_open = k, False
            while s <= beyond:
                # The segment is kept if the winding number at its midpoint is at least tau.
                if is_constant:
                    is_kept, until = crossings >= required, beyond + 1
                elif (s == k and c == begin) or (s == beyond and c == end):  # to a wall
                    is_kept, until = False, s + 1
                else:
                    left = before if s == k else (s - 0.5) / resolution
                    right = after if s == beyond else (s + 0.5) / resolution
                    middle = 0.5 * (left + right)
                    while cap < last_cap and cap_position[cap] <= middle:
                        cap_crossings -= cap_sign[cap]
                        cap += 1
                    cell = min(int(middle * resolution), resolution - 1)
                    stop = beyond + (c < end)
                    if cap < last_cap:
                        stop = min(stop, int(cap_position[cap] * resolution))
                    cell_class, until = class_at(classes, axis, (i, j), cell, stop)
                    pu, pv = (i + 0.5) / resolution, (j + 0.5) / resolution
                    if cell_class < 0:  # holds for all segments of this class up to the next hit
                        is_kept = crossings + cap_crossings >= cell_class - CONSTANT
                    else:
                        until = cell + 1
                        undecided += listing
                        point = in_space(axis, pu, pv, middle)
                        needed = AMBIGUOUS
                        if expansions.is_crossed[cell_class]:
                            value, error = value_at(expansions, cell_class, point)
                            needed = required_crossings(tau + value, error)
                        if needed < AMBIGUOUS:
                            if not listing and cell_class != crossed:
                                where = pu, pv, middle
                                offset = _crossed_offset(
                                    shared, rays, where, point, cell_class, cap_crossings, points
                                )
                                crossed = cell_class
                            is_kept = not listing and crossings + offset >= needed
                        elif listing:
                            row[query] = cell_class
                            queries[query, 0], queries[query, 1], queries[query, 2] = point
                            queries[query, SLACK] = crossings + cap_crossings - tau
                            is_kept, query = False, query + 1
                        else:
                            is_kept = results[query] == INSIDE
                            if results[query] == UNDECIDED:
                                angle = _rest(boundary, rays, (pu, pv, middle))
                                winding_number = crossings + angle
                                is_kept = winding_number >= tau
                            query += 1
                    until = max(s + 1, min(until, beyond + (c < end)))
                if is_kept and not is_open:
                    rows[count, 0] = r
                    rows[count, 1] = k if s == k else s - 1
                    rows[count, 3] = c - 1 if s == k and c > begin else NONE
                elif is_open and not is_kept:
                    rows[count, 2], rows[count, 4] = s - 1, NONE
                    count += 1
                s, is_open = until, is_kept
            # Intervals end at every hit: what follows is another interval. From the wall
            # straight to a hit there is no segment.
            if is_open and (beyond > k or begin < c < end):
                rows[count, 2] = beyond - 1
                rows[count, 4] = c if c < end else NONE
                count += 1
            k = beyond
    return last_ray, (count, query, undecided)


@no_refcount
def _crossed_offset(shared, rays, where, point, row, cap_crossings, points):
    """Return the whole number n of a ray in a block crossed by caps: w = crossings + n - expansion.

    Where the ray passes a cap, cap crossing count and winding number of the caps jump alike.
    Their difference is smooth, and n is the same all along the ray in this block: one evaluation,
    at any point, gives it.
    """
    _, _, classes, boundary, clusters, every = shared
    value, error = value_at(classes.expansions, row, point)
    points[0], points[Y], points[Z] = point
    alone = np.int64(1)  # a literal has another type, compiled anew
    error += caps_winding_numbers(clusters, every, point, 0.0, FIRST, points, alone)
    angle = cap_crossings - points[VALUE]
    if error >= 0.5 or points[CLEAR] <= 0:
        angle = _rest(boundary, rays, where)
    return np.int64(np.round(angle + value))


@no_refcount
def _rest(boundary, rays, where):
    """Return the winding number less the crossings ahead, by the exact formula."""
    axis, vertices = rays[:2]
    sense = -1.0 if axis == 1 else 1.0  # (x, z, y) is left-handed
    return sense * boundary_angle(vertices, boundary, where[0], where[1], where[2])


@compiled(inline="always")
def _signed_count(sign, begin, end):
    """Sum the signs of hits."""
    total = 0
    for k in range(begin, end):
        total += sign[k]
    return total
