"""Sparse L D Lᵀ factorisation of a symmetric matrix: ordering, factors, substitution.

A matrix is given by rows as in `scipy.sparse.csr_array`: (start, column, value). The fill-reducing
ordering follows from its pattern alone, so that it is found before the values are known. There is
less overhead than in a general factorisation, which for small meshes is most of the time.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geodesics.any_angle.queue import END, join, leave
from ...runtime.compiled import compiled, copy_to, no_refcount
from .lanes import NOTHING, minus, row_of, set_row

LINKS = np.dtype([("after", np.int32), ("before", np.int32)], align=True)
"""Neighbours in the list of the unknowns of one degree, see `geodesics.queue`."""

Factors = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]
"""L below its diagonal of ones, by columns: starts, rows, values; and D."""


@compiled
def fill_reducing_ordering(start, column):
    """Order the unknowns by approximate minimum degree, so that the factors have few entries.

    Adjacency is kept as cliques. At first these are the edges; to eliminate an unknown unites its
    cliques into one. An unknown's degree is bounded from above.

    Returns shapes (k,).

    References
    ----------
    Amestoy, Davis & Duff 1996, "An approximate minimum degree ordering algorithm".
    """
    count = len(start) - 1
    begin, member, member_of, memberships = _edges_as_cliques(start, column)
    edges = len(member) // 2
    size = np.full(len(begin), 2, np.int32)
    outside = np.empty(len(begin), np.int32)
    last_met = np.full(len(begin), -1, np.int32)  # the step that met a clique
    last_seen = np.full(count, -1, np.int32)  # and an unknown

    degree = memberships.copy()
    head, links = np.full(count, END, np.int32), np.empty(count, LINKS)
    for v in range(count - 1, -1, -1):
        join(head, links, degree[v], v)
    order = np.empty(count, np.int32)
    used, least = len(member), 0
    for step in range(count):
        while head[least] == END:
            least += 1
        pivot, clique = head[least], edges + step
        leave(head, links, pivot)
        order[step], last_seen[pivot] = pivot, count
        if used + count > len(member):
            larger = np.empty(2 * len(member) + count, np.int32)
            copy_to(member, larger)
            member = larger
        begin[clique] = used
        mine = member_of[start[pivot] : start[pivot] + memberships[pivot]]
        used = _unite(mine, begin, size, member, used, last_seen, step)
        size[clique] = used - begin[clique]
        others = member[begin[clique] : used]
        _count_outside(others, start, member_of, memberships, size, outside, last_met, step)
        for v in others:
            found = _relist(v, clique, start, member_of, memberships, size, outside)
            found = min(found, count - step - 2)
            if found != degree[v]:
                leave(head, links, v)
                join(head, links, found, v)
                degree[v] = found
                least = min(least, found)
    return order


@compiled
def _edges_as_cliques(start, column):
    """Return where cliques begin, their members, and the cliques of each unknown.

    Those of v are member_of[start[v] : start[v] + memberships[v]]: never more than its edges, as a
    new clique replaces at least one.
    """
    count, edges = len(start) - 1, 0
    member_of, memberships = np.empty(len(column), np.int32), np.zeros(count, np.int32)
    member = np.empty(len(column), np.int32)
    for v in range(count):
        for e in range(start[v], start[v + 1]):
            if column[e] < v:
                member[2 * edges], member[2 * edges + 1] = v, column[e]
                for end in member[2 * edges : 2 * edges + 2]:
                    member_of[start[end] + memberships[end]] = edges
                    memberships[end] += 1
                edges += 1
    begin = np.empty(edges + count, np.int32)
    for c in range(edges):
        begin[c] = 2 * c
    return begin, member[: 2 * edges].copy(), member_of, memberships


@no_refcount
def _unite(cliques, begin, size, member, used, last_seen, step):
    """Append the union of some cliques, which become empty; return where it ends."""
    for c in cliques:
        for m in range(begin[c], begin[c] + size[c]):
            v = member[m]
            if last_seen[v] < step:
                last_seen[v] = step
                member[used] = v
                used += 1
        size[c] = 0
    return used


@no_refcount
def _count_outside(others, start, member_of, memberships, size, outside, last_met, step):
    """Count how many members of each clique are not in the new one."""
    for v in others:
        for k in range(start[v], start[v] + memberships[v]):
            c = member_of[k]
            if last_met[c] != step:
                last_met[c], outside[c] = step, size[c]
            outside[c] -= 1


@no_refcount
def _relist(v, clique, start, member_of, memberships, size, outside):
    """List the cliques of v again, with the new one; return a bound on its degree."""
    touched, kept = size[clique] - 1, start[v]
    for k in range(start[v], start[v] + memberships[v]):
        c = member_of[k]
        if size[c] > 0 and outside[c] > 0:
            member_of[kept] = c
            kept += 1
            touched += outside[c]
        else:  # all of it is in the new one
            size[c] = 0
    member_of[kept] = clique
    memberships[v] = kept + 1 - start[v]
    return touched


@compiled
def factorise(start, column, value, diagonal, order, pace):
    """Compute L D Lᵀ of a positive definite matrix, row after row.

    Shapes: diagonal (k,), order (k,), pace (2,).

    References
    ----------
    Davis 2005, "Algorithm 849: a concise sparse Cholesky factorization package".
    """
    count = len(order)
    rank, parent = np.empty(count, np.int32), np.full(count, -1, np.int32)
    for k in range(count):
        rank[order[k]] = k
    path, last_met = np.empty(count, np.int32), np.full(count, -1, np.int32)
    begin = np.zeros(count + 1, np.int32)
    for k in range(count):
        for e in range(start[order[k]], start[order[k] + 1]):
            i = rank[column[e]]
            while i < k and last_met[i] != k:
                last_met[i] = k
                begin[i + 1] += 1
                if parent[i] < 0:
                    parent[i] = k
                i = parent[i]
    for k in range(count):
        begin[k + 1] += begin[k]

    rows, values = np.empty(begin[-1], np.int32), np.empty(begin[-1])
    end, pivots = begin[:-1].copy(), np.empty(count)
    row = np.zeros(count)
    last_met[:] = -1
    for k in range(count):
        pace[0] = k
        if pace[1] != 0:
            break
        v = order[k]
        # The entries of row k: all on the paths up the elimination tree from those of the matrix.
        first = count
        for e in range(start[v], start[v + 1]):
            i = rank[column[e]]
            if i >= k:
                continue
            row[i] = value[e]
            length = 0
            while i < k and last_met[i] != k:
                path[length], last_met[i] = i, k
                length += 1
                i = parent[i]
            for up in range(length - 1, -1, -1):
                first -= 1
                path[first] = path[up]
        pivot = diagonal[v]
        for i in path[first:]:
            here, row[i] = row[i], 0.0
            for p in range(begin[i], end[i]):
                row[rows[p]] -= values[p] * here
            rows[end[i]], values[end[i]] = k, here / pivots[i]
            pivot -= here * values[end[i]]
            end[i] += 1
        pivots[k] = pivot
    return begin, rows, values, pivots


@no_refcount
def substitute(begin, rows, values, pivots, right, pace):
    """Solve L D Lᵀ x = b for several b at once, shape (k, RIGHT_SIDES), in place.

    `pace`: see `threads.watched`; there are 2 k steps.
    """
    count = len(pivots)
    for c in range(count):
        pace[0] = c
        if pace[1] != 0:
            return
        here = row_of(right, c)
        if here != NOTHING:
            for p in range(begin[c], begin[c + 1]):
                set_row(right, rows[p], minus(row_of(right, rows[p]), values[p], here))
    for c in range(count - 1, -1, -1):
        pace[0] = 2 * count - c
        if pace[1] != 0:
            return
        here = minus(NOTHING, -1 / pivots[c], row_of(right, c))
        for p in range(begin[c], begin[c + 1]):
            here = minus(here, values[p], row_of(right, rows[p]))
        set_row(right, c, here)
