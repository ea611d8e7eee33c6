"""Nested dissection: an order of a surface's vertices in which its equations have small factors.

A separator is a set of vertices without which a surface falls into two parts. Separators come last,
and either part is divided in the same way, down to small blocks. Then the factors of a block
concern its own vertices and its border alone: those vertices of separators that it leads to.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled, copy_to

MIN_PART = 8
"""Parts of up to this many vertices are not divided."""
PENDING = 64
"""Parts that wait to be divided, at most: each is larger than all those that wait after it."""
NO_SEPARATOR = 0.01
"""Vertices that a separator of none counts as: it is better the more equal the parts are."""


class Dissection(NamedTuple):
    """Blocks of vertices, each before the separator beside it, its parent.

    Parameters
    ----------
    vertex, position : arrays, shape (k,), int32
        The vertices in order, and where each is in it.
    begin : array, shape (b + 1,), int32
        Block t is at begin[t] to begin[t + 1] in the order.
    parent : array, shape (b,), int32
        The parent of each block; b for none.
    border_begin : array, shape (b + 1,), int64
        The border of block t is at border_begin[t] to border_begin[t + 1] in `border`.
    border : array, int32
        Places in the order, ascending within each border.
    """

    vertex: NDArray[np.int32]
    position: NDArray[np.int32]
    begin: NDArray[np.int32]
    parent: NDArray[np.int32]
    border_begin: NDArray[np.int64]
    border: NDArray[np.int32]


def dissect(start: NDArray[np.int32], column: NDArray[np.int32]) -> Dissection:
    """Dissect a symmetric matrix, of which each row begins with the diagonal.

    References
    ----------
    George & Liu 1978, "An automatic nested dissection algorithm for irregular finite element
    problems".
    """
    vertex, begin, parent = _dissect(start, column)
    begin, parent = begin[::-1].copy(), (len(parent) - 1 - parent[::-1]).astype(np.int32)
    position = np.empty_like(vertex)
    position[vertex] = np.arange(len(vertex), dtype=np.int32)
    block = np.repeat(np.arange(len(parent), dtype=np.int32), np.diff(begin))
    borders = _borders(start, column, vertex, position, block, parent)
    return Dissection(vertex, position, begin, parent, *borders)


@compiled
def _dissect(start, column):
    """Return the order, and blocks from its end on: where they end, and parents, -1 for none."""
    count = len(start) - 1
    vertex, queue = np.arange(count).astype(np.int32), np.empty(count, np.int32)
    level, label, labels = np.empty(count, np.int32), np.zeros(count, np.int32), 0
    low, high = np.zeros(PENDING, np.int64), np.full(PENDING, count)
    above, waiting = np.full(PENDING, -1), 1
    ends, parent, blocks = np.zeros(count + 1, np.int32), np.empty(count, np.int32), 0
    while waiting > 0:
        waiting -= 1
        begin, end, separator = low[waiting], high[waiting], above[waiting]
        part = vertex[begin:end]
        first, last = 0, len(part)
        if len(part) > MIN_PART:
            for _ in range(2):  # the second search begins far out, where the first one ends
                labels += 1
                _search(start, column, part, label, labels, queue, level)
            first, last = _narrowest(level, len(part))
        if last > first:
            ends[blocks], parent[blocks] = end, separator
            separator = blocks
            blocks += 1
        # The larger part comes first, then the other, then the separator.
        copy_to(part, queue)
        both = len(part) - last + first
        larger, other = (0, last) if first >= both - first else (last, 0)
        size = max(first, both - first)
        for k in range(both):
            part[k] = queue[larger + k] if k < size else queue[other + k - size]
        for k in range(first, last):
            part[both + k - first] = queue[k]
            label[queue[k]] = -1
        if size > 0:
            low[waiting], high[waiting], above[waiting] = begin, begin + size, separator
            waiting += 1
            low[waiting], high[waiting], above[waiting] = begin + size, begin + both, separator
            waiting += 1
    return vertex, ends[: blocks + 1], parent[:blocks]


@compiled
def _search(start, column, part, label, new, queue, level):
    """Order a part breadth first from its last vertex, and give its vertices a new label.

    Levels are numbered from each component's first vertex on, a number is left out between two.
    """
    count, depth, old = 0, 0, label[part[0]]
    for k in range(len(part) - 1, -1, -1):
        if label[part[k]] != old:
            continue
        queue[count], level[count], label[part[k]] = part[k], depth, new
        done, count = count, count + 1
        while done < count:
            v, depth = queue[done], level[done] + 1
            for e in range(start[v] + 1, start[v + 1]):
                u = column[e]
                if label[u] == old:
                    queue[count], level[count], label[u] = u, depth, new
                    count += 1
            done += 1
        depth += 1
    copy_to(queue[:count], part)


@compiled
def _narrowest(level, count):
    """Return where the best separator begins and ends: a level, or nothing between components.

    It is narrow beside the smaller part. What has no separator stays whole.
    """
    first, last, least, begin = 0, count, np.inf, 0
    for k in range(1, count):
        if level[k] > level[k - 1]:
            side = min(begin, count - k)
            if k - begin + NO_SEPARATOR < least * side:
                first, last, least = begin, k, (k - begin + NO_SEPARATOR) / side
            if level[k] > level[k - 1] + 1:
                side = min(k, count - k)
                if least * side > NO_SEPARATOR:
                    first, last, least = k, k, NO_SEPARATOR / side
            begin = k
    return first, last


@compiled
def _borders(start, column, vertex, position, block, parent):
    """Return where the borders of blocks begin, and the borders."""
    at, border = np.zeros(len(parent) + 2, np.int64), np.empty(0, np.int32)
    for is_counted in (False, True):
        reached = np.full(len(parent), -1, np.int32)
        for k in range(len(vertex)):
            # Blocks from each neighbour's up to the vertex's own lead to the vertex.
            v = vertex[k]
            reached[block[k]] = k
            for e in range(start[v] + 1, start[v + 1]):
                t = block[min(position[column[e]], k)]
                while reached[t] != k:
                    reached[t] = k
                    if is_counted:
                        border[at[t + 1]] = k
                        at[t + 1] += 1
                    else:
                        at[t + 2] += 1
                    t = parent[t]
        if not is_counted:
            at = np.cumsum(at)
            border = np.empty(at[-1], np.int32)
    return at[:-1], border
