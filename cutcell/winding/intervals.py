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

from ..compiled import compiled, no_refcount
from ..memory import check_room
from ..progress import Tell, share_of
from ..surface.rays import (
    AXES,
    RayHits,
    cast_all_rays,
    first_at_least,
    in_space,
    strip_bounds,
)
from ..threads import in_threads
from .boundary import Boundary
from .caps import smallest_caps
from .cells import AMBIGUOUS, BLOCK, CONSTANT, class_at, classify_cells, required_crossings
from .clusters import ROOT, build_tree
from .exact import boundary_angle
from .expansion import value_at
from .queries import FIRST, INSIDE, SLACK, UNDECIDED, query_points
from .solid_angles import CLEAR, VALUE, WORKSPACE, Y, Z, caps_winding_numbers

NONE = -1
BYTES_PER_QUERY = 80
"""Peak of answering queries, beside their list."""
NO_RESULTS = np.zeros(0, np.uint8)


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
    segments = sum(resolution**3 + len(h.position) for h in hits)
    strips = strip_bounds(resolution, segments)
    work = [(rays, i * resolution, j * resolution) for rays in families for i, j in strips]
    listed: list[int] = []

    def keep(rays, ray, last_ray, results=None):
        start = rays[3][0]
        most = 2 * int(start[last_ray] - start[ray] + resolution + 1)
        rows = np.empty((most, 5), np.int32)
        row, queries = np.empty(256, np.int32), np.empty((256, SLACK + 1))
        points, filled = np.empty(WORKSPACE), (0, 0, 0)
        listing = results is None
        given = shared, rays, last_ray, NO_RESULTS if listing else results, listing
        while ray < last_ray:
            ray, filled = _keep_segments(*given, ray, filled, rows, row, queries, points)
            if ray < last_ray:
                rows, row, queries = _doubled(rows), _doubled(row), _doubled(queries)
        return rows[: filled[0]], row[: filled[1]], queries[: filled[1]], filled[2] > 0

    def list_queries(strip):
        found = keep(*strip)
        listed.append(len(found[1]))
        check_room(
            sum(listed) * BYTES_PER_QUERY,
            f"{sum(listed):,} midpoints among holes and loose triangles",
            "choose a lower resolution",
        )
        return found

    first = in_threads(list_queries, work, share_of(tell, 0.3, 0.5))
    kept = [found[0] for found in first]
    again = [k for k, (*_, is_undecided) in enumerate(first) if is_undecided]
    if again:
        row, queries = (np.concatenate([first[k][column] for k in again]) for column in (1, 2))
        ends = np.cumsum([len(first[k][1]) for k in again])
        telling = share_of(tell, 0.5, 0.9)
        results = query_points(classes.expansions, clusters, row, queries, telling)
        decided = in_threads(
            lambda part: keep(*work[part[0]], part[1])[0],
            zip(again, np.split(results, ends[:-1]), strict=True),
            share_of(tell, 0.9, 1),
        )
        for k, intervals in zip(again, decided, strict=True):
            kept[k] = intervals
    count = len(strips)
    of_axes = [np.concatenate(kept[count * k : count * (k + 1)]) for k in range(3)]
    return [InsideIntervals(*np.ascontiguousarray(of_axis.T)) for of_axis in of_axes]


def _doubled(array: NDArray) -> NDArray:
    """Return a copy with twice the capacity."""
    return np.concatenate([array, np.empty_like(array)])


def _constant_columns(coarse: NDArray[np.int32], along: int) -> NDArray[np.int32]:
    """Return the required crossing count of each column of blocks, or AMBIGUOUS."""
    least = coarse.min(axis=along)
    is_constant = (least == coarse.max(axis=along)) & (least < 0)
    return np.where(is_constant, least - CONSTANT, AMBIGUOUS).astype(np.int32)


@no_refcount
def _keep_segments(
    shared, rays, last_ray, results, listing, first_ray, filled, rows, row, queries, points
):
    """Run algorithm 1 on rays while there is room.

    Writes the intervals as `rows` (ray, first, last, low, high). When `listing` it has no results
    yet and lists the queries: the row of the expansions, and what `query_points` takes. `points`
    is a workspace.

    Returns
    -------
    next_ray : int
    filled : tuple of 3 ints
        Number of intervals, of queries, and of segments that are undecided when listing.
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
                    kept, until = crossings >= required, beyond + 1
                elif (s == k and c == begin) or (s == beyond and c == end):  # to a wall
                    kept, until = False, s + 1
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
                        kept = crossings + cap_crossings >= cell_class - CONSTANT
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
                            kept = not listing and crossings + offset >= needed
                        elif listing:
                            row[query] = cell_class
                            queries[query, 0], queries[query, 1], queries[query, 2] = point
                            queries[query, SLACK] = crossings + cap_crossings - tau
                            kept, query = False, query + 1
                        else:
                            kept = results[query] == INSIDE
                            if results[query] == UNDECIDED:
                                angle = _rest(boundary, rays, (pu, pv, middle))
                                winding_number = crossings + angle
                                kept = winding_number >= tau
                            query += 1
                    until = max(s + 1, min(until, beyond + (c < end)))
                if kept and not is_open:
                    rows[count, 0] = r
                    rows[count, 1] = k if s == k else s - 1
                    rows[count, 3] = c - 1 if s == k and c > begin else NONE
                elif is_open and not kept:
                    rows[count, 2], rows[count, 4] = s - 1, NONE
                    count += 1
                s, is_open = until, kept
            # Intervals end at every hit: what follows is an interval of its own. From the wall
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

    Where the ray passes a cap, the cap crossing count and the caps' winding number jump alike. So
    their difference is smooth, and n is the same all along the ray in this block: one evaluation,
    at any point, gives it.
    """
    _, _, classes, boundary, clusters, every = shared
    value, error = value_at(classes.expansions, row, point)
    points[0], points[Y], points[Z] = point
    alone = np.int64(1)  # a literal would be a type of its own, compiled anew
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
