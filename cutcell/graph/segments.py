"""Which pieces of the rays lie inside the body (paper section 3.1, figure "ray segments").

Crossings and lattice points dice each ray into segments; a segment is kept when the
winding number at its midpoint is at least tau. Kept segments that follow one another are
stored as a run, so memory grows with the surface, not with the volume.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled, lean
from ..memory import check_room
from ..progress import Tell, share_of
from ..threads import in_threads
from .asked import ABOVE, INSIDE, UNTOLD, answer
from .boundary import Boundary
from .caps import cap_holes
from .clusters import ROOT
from .cover import CLEAR, ROOM, VALUE, Y, Z, cover
from .doubt import BLOCK, NEED, UNSURE, code_at, in_field, need_between
from .holes import find_doubt
from .rays import AXES, Crossings, cast_all_rays, first_at_least, grown, in_space, strip_bounds
from .winding import boundary_turns

NONE = -1
BYTES_PER_QUERY = 80
"""Once midpoints are listed, to answer them takes so much more."""
NO_ANSWERS = np.zeros(0, np.uint8)


@dataclass(frozen=True, eq=False)
class Runs:
    """Stretches of kept segments along the rays of one axis, in the order of the rays.

    A run goes from a crossing (or NONE) over the lattice points `first` to `last` to
    another crossing (or NONE). It holds no lattice point when `last` is below `first`.

    Parameters
    ----------
    ray, first, last, low, high : arrays, shape (r,), int32
        `low` and `high` are indices into the axis' `Crossings`, or -1.
    """

    ray: NDArray[np.int32]
    first: NDArray[np.int32]
    last: NDArray[np.int32]
    low: NDArray[np.int32]
    high: NDArray[np.int32]


def find_runs(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    crossings: Sequence[Crossings],
    boundary: Boundary,
    resolution: int,
    winding_threshold: float,
    tell: Tell = lambda done: None,
) -> list[Runs]:
    """Find the kept segments along x, y and z.

    Parameters
    ----------
    vertices : array, shape (n, 3), float64
        Unit-cube coordinates.
    faces : array, shape (m, 3), int32
    crossings : sequence of Crossings
        Of the rays along x, y and z.
    boundary : Boundary
        Of the mesh.
    resolution : int
    winding_threshold : float
        tau: segments with at least this winding number are kept.
    tell : callable
        See `progress.Tell`.
    """
    caps = cap_holes(vertices, faces, boundary)
    tell(0.05)
    closing = cast_all_rays(caps.vertices, caps.faces, resolution, share_of(tell, 0.05, 0.15))
    doubt = find_doubt(caps, resolution, winding_threshold, share_of(tell, 0.15, 0.3))
    shared = resolution, winding_threshold, doubt, boundary
    views = []
    for axis, (u, v, along) in enumerate(AXES):
        needs = doubt.coarse.min(axis=along)
        calm = np.where(needs == doubt.coarse.max(axis=along), needs, 0)
        calm = np.where(calm < 0, calm - NEED, UNSURE).astype(np.int32)
        found = tuple((c.start, c.position, c.sign) for c in (crossings[axis], closing[axis]))
        views.append((axis, np.ascontiguousarray(vertices[:, [u, v, along]]), calm, *found))

    walked = sum(resolution**3 + len(c.position) for c in crossings)
    strips = strip_bounds(resolution, walked)
    work = [(seen, i * resolution, j * resolution) for seen in views for i, j in strips]
    asked: list[int] = []

    def list_queries(part):
        found = _walk_rays(shared, *part, NO_ANSWERS, True)
        asked.append(len(found[1]))
        check_room(
            sum(asked) * BYTES_PER_QUERY,
            f"{sum(asked):,} midpoints among holes and loose triangles",
            "choose a lower resolution",
        )
        return found

    listed = in_threads(list_queries, work, share_of(tell, 0.3, 0.5))
    rows = [found for found, *_ in listed]
    unsure = [k for k, (*_, is_done) in enumerate(listed) if not is_done]
    if unsure:
        leaf, queries = (np.concatenate([listed[k][column] for k in unsure]) for column in (1, 2))
        ends = np.cumsum([len(listed[k][1]) for k in unsure])
        answers = answer(doubt, leaf, queries, share_of(tell, 0.5, 0.9))
        again = in_threads(
            lambda told: _walk_rays(shared, *work[told[0]], told[1], False)[0],
            zip(unsure, np.split(answers, ends[:-1]), strict=True),
            share_of(tell, 0.9, 1),
        )
        for k, found in zip(unsure, again, strict=True):
            rows[k] = found
    count = len(strips)
    of_axes = [np.concatenate(rows[count * k : count * (k + 1)]) for k in range(3)]
    return [Runs(*np.ascontiguousarray(of_axis.T)) for of_axis in of_axes]


@compiled
def _walk_rays(shared, seen, first_ray, last_ray, answers, is_listing):
    """List the runs of a strip of rays, as rows (ray, first, last, low, high).

    First it is listed which midpoints to ask about: the leaf of each, and what `answer` takes.
    With the answers, in the same order, the rays are walked once more, unless nothing was asked.
    """
    rows = np.empty((256, 5), np.int32)
    leaf, queries = np.empty(256, np.int32), np.empty((256, ABOVE + 1))
    torn, tools = np.empty(2, np.int64), (np.full(1, ROOT, np.int32), np.empty(ROOM))
    filled, is_done = (0, 0), True
    while first_ray < last_ray:
        room = rows, leaf, queries, answers, torn, tools
        ray, filled, is_sure = _walk(shared, seen, first_ray, last_ray, is_listing, filled, *room)
        if ray < last_ray:
            rows, leaf, queries = grown(rows), grown(leaf), grown(queries)
        first_ray, is_done = ray, is_done and is_sure
    return rows[: filled[0]], leaf[: filled[1]], queries[: filled[1]], is_done


@lean
def _walk(
    shared,
    seen,
    first_ray,
    last_ray,
    is_listing,
    filled,
    rows,
    leaf,
    queries,
    answers,
    torn,
    tools,
):
    """Walk rays while there is room; return who is next, what is filled, and if all was sure."""
    resolution, calm, start, cap_start = shared[0], seen[2], seen[3][0], seen[4][0]
    count, asked = filled
    is_sure = True
    for r in range(first_ray, last_ray):
        crossings, caps = start[r + 1] - start[r], cap_start[r + 1] - cap_start[r]
        need = calm[r // resolution // BLOCK, r % resolution // BLOCK]
        if crossings == caps == 0 < need < UNSURE:
            continue  # it passes the body by
        segments = resolution + crossings + 1
        is_full = count + 2 * segments > len(rows)
        if is_full or (is_listing and asked + segments > len(leaf)):
            return r, (count, asked), is_sure
        room = rows, leaf, queries, answers, torn, tools
        count, asked, sure = _walk_ray(shared, seen, r, is_listing, count, asked, *room)
        is_sure &= sure
    return last_ray, (count, asked), is_sure


@lean
def _walk_ray(shared, seen, r, is_listing, count, asked, rows, leaf, queries, answers, torn, tools):
    """Add the runs and queries of one ray; return how many there are, and if all was sure."""
    resolution, tau, doubt = shared[:3]
    axis, _, calm, (start, position, sign), (cap_start, cap_position, cap_sign) = seen
    begin, end = start[r], start[r + 1]
    passed, last_cap = cap_start[r], cap_start[r + 1]
    chi = 0
    for c in range(begin, end):
        chi += sign[c]
    # Far from holes, no winding number changes between two crossings.
    i, j = r // resolution, r % resolution
    need = calm[i // BLOCK, j // BLOCK]
    is_calm = need < UNSURE and passed == last_cap
    is_sure = True
    lid = 0  # crossings ahead with the caps, counted like chi
    for c in range(passed, last_cap):
        lid += cap_sign[c]
    torn[0] = NONE
    k = 0
    # Gap by gap: from the crossing c - 1 (or the cube's wall) to the crossing c.
    for c in range(begin, end + 1):
        if c > begin:
            chi -= sign[c - 1]
        before = position[c - 1] if c > begin else 0.0
        after = position[c] if c < end else 1.0
        beyond = first_at_least(after, resolution) if c < end else resolution
        # Segment s of the gap ends at lattice point s; the last one at crossing c.
        s, is_open = k, False
        while s <= beyond:
            if is_calm:
                kept, until = chi >= need, beyond + 1
            elif (s == k and c == begin) or (s == beyond and c == end):  # to a wall
                kept, until = False, s + 1
            else:
                left = before if s == k else (s - 0.5) / resolution
                right = after if s == beyond else (s + 0.5) / resolution
                middle = 0.5 * (left + right)
                while passed < last_cap and cap_position[passed] <= middle:
                    lid -= cap_sign[passed]
                    passed += 1
                cell = min(int(middle * resolution), resolution - 1)
                stop = beyond + (c < end)
                if passed < last_cap:
                    stop = min(stop, int(cap_position[passed] * resolution))
                code, same = code_at(doubt, axis, (i, j), cell, stop)
                if code < 0:
                    # So it stays while cells have this code, or to the next crossing.
                    kept, until = chi + lid >= code - NEED, same
                else:
                    p = (i + 0.5) / resolution, (j + 0.5) / resolution, middle
                    point = in_space(axis, p[0], p[1], p[2])
                    kept, until = False, cell + 1
                    is_asked = _is_asked(doubt.leaves, code, point, tau)
                    if not is_listing and is_asked:
                        kept = _as_answered(shared, seen, p, answers[asked], chi)
                    elif not is_listing:
                        kept = _in_torn(shared, seen, p, point, code, chi, lid, torn, tools)
                    elif is_asked:
                        leaf[asked] = code
                        queries[asked, 0], queries[asked, 1], queries[asked, 2] = point
                        queries[asked, ABOVE] = chi + lid - tau
                    asked += is_asked
                    is_sure = False
                until = max(s + 1, min(until, beyond + (c < end)))
            if kept and not is_open:
                rows[count, 0] = r
                rows[count, 1] = k if s == k else s - 1
                rows[count, 3] = c - 1 if s == k and c > begin else NONE
            elif is_open and not kept:
                rows[count, 2], rows[count, 4] = s - 1, NONE
                count += 1
            s, is_open = until, kept
        # A run ends at every crossing: what follows starts there as a run of its own.
        # From the wall straight to a crossing there is no segment.
        if is_open and (beyond > k or begin < c < end):
            rows[count, 2] = beyond - 1
            rows[count, 4] = c if c < end else NONE
            count += 1
        k = beyond
    return count, asked, is_sure


@lean
def _is_asked(leaves, leaf, point, tau):
    """Tell whether a midpoint has to be asked about: its leaf is not torn, or does not tell."""
    if not leaves.is_torn[leaf]:
        return True
    value, error = in_field(leaves, leaf, point)
    return need_between(tau + value, error) == UNSURE


@lean
def _as_answered(shared, seen, p, answer, chi):
    """Tell whether a midpoint is inside, given the answer."""
    if answer != UNTOLD:
        return answer == INSIDE
    _, tau, _, boundary = shared
    return chi + _turns(seen, boundary, p) >= tau


@lean
def _in_torn(shared, seen, p, point, leaf, chi, lid, torn, tools):
    """Tell whether a midpoint is inside, in a torn block whose field says the need.

    `torn` keeps the last torn block that the ray came through, and the number of caps
    ahead that its field goes with; `tools` are the cluster of all caps and room for `cover`.
    """
    (_, tau, doubt, boundary), (every, room) = shared, tools
    value, error = in_field(doubt.leaves, leaf, point)
    if torn[0] != leaf:
        room[0], room[Y], room[Z] = point
        alone = np.int64(1)  # for a plain 1 all would be compiled once more
        off = cover(doubt.clusters, every, point, 0.0, 1e-2, room, alone)
        turns = lid - room[VALUE]
        if off + error >= 0.5 or room[CLEAR] <= 0:
            turns = _turns(seen, boundary, p)
        torn[0], torn[1] = leaf, np.int64(np.round(turns + value))
    return chi + torn[1] >= need_between(tau + value, error)


@compiled(inline="always")
def _turns(seen, boundary, p):
    """Return what is missing from the crossings ahead to the winding number."""
    axis, vertices = seen[:2]
    turn = -1.0 if axis == 1 else 1.0  # (x, z, y) is left-handed
    return turn * boundary_turns(vertices, boundary, p[0], p[1], p[2])
