"""Triangular factors of a surface's equations, block by block, and solutions by them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.dissection import Dissection
from ...runtime.compiled import compiled, vectorized

LANES = 8
"""Right sides that are solved for at once."""


class Factors(NamedTuple):
    """Factors of a symmetric positive definite matrix, shape (k, k): L D L'.

    Parameters
    ----------
    blocks : Dissection
    at : array, shape (b + 1,), int64
        Where the values of each block begin.
    value : array
        D on the diagonal and L' right of it: for each vertex of a block the columns from its own
        on, first of the block, then of its border.
    """

    blocks: Dissection
    at: NDArray[np.int64]
    value: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        blocks: Dissection,
        rows: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]],
        least: float,
    ) -> Factors:
        """Factorise the matrix whose rows were dissected; each begins with the diagonal.

        No pivot is smaller than `least` times the diagonal: rounding might leave it negative.
        """
        size, border = np.diff(blocks.begin).astype(np.int64), np.diff(blocks.border_begin)
        at = np.append(0, np.cumsum(size * (size + 1) // 2 + size * border))
        value, widest = np.zeros(at[-1]), int((size + border).max(initial=0))
        scratch = np.empty(len(blocks.vertex), np.int32), np.empty(widest)
        _factorise(*blocks, *rows, least, at, value, *scratch)
        return cls(blocks, at, value)

    def solve(
        self, row: NDArray[np.integer], number: NDArray[np.integer], right: NDArray[np.float64],
        negligible: float,
    ) -> tuple[NDArray[np.integer], NDArray[np.integer], NDArray[np.float64]]:  # fmt: skip
        """Solve for up to `LANES` right sides: the row, number and value of each entry, (e,).

        Returns the entries of the solutions that are larger than `negligible`. A block whose
        border has none has none either, unless it has a right side (maximum principle).
        """
        count, blocks = len(self.blocks.vertex), len(self.blocks.parent)
        place = self.blocks.position[row]
        x = np.zeros((count, LANES))
        x[place, number] = right
        is_reached, is_negligible = np.zeros((2, blocks + 1), np.bool_)
        is_reached[np.searchsorted(self.blocks.begin, place, "right") - 1] = True
        is_negligible[-1] = True  # the parent of those without one
        most = count * LANES  # only as much of these takes memory as is used
        vertex, lane = np.empty(most, np.int32), np.empty(most, np.uint8)
        value = np.empty(most)
        entries = _substitute(*self.blocks, self.at, self.value, x, is_reached, is_negligible,
                            negligible, vertex, lane, value)  # fmt: skip
        return vertex[:entries].copy(), lane[:entries].copy(), value[:entries].copy()


@compiled(inline="always")
def _row(at, width, i):
    """Return where the row i of a block has its column 0, which is not stored for i > 0."""
    return at + i * width - i * (i + 1) // 2


@vectorized
def _subtract(target, factor, source):
    for i in range(len(target)):
        target[i] -= factor * source[i]


@vectorized
def _divide(target, divisor):
    for i in range(len(target)):
        target[i] /= divisor


@vectorized
def _factorise(
    vertex, position, begin, parent, border_begin, border,
    start, column, matrix, least, at, value, local, row,
):  # fmt: skip
    """Write the factors of a matrix; `value` is zero, `local` and `row` are scratch space."""
    blocks = len(parent)
    for t in range(blocks):
        low, high = begin[t], begin[t + 1]
        width = high - low + border_begin[t + 1] - border_begin[t]
        for k in range(border_begin[t], border_begin[t + 1]):
            local[border[k]] = high - low + k - border_begin[t]
        for i in range(high - low):
            v, offset = vertex[low + i], _row(at[t], width, i)
            for e in range(start[v], start[v + 1]):
                k = position[column[e]]
                if k >= high:
                    value[offset + local[k]] += matrix[e]
                elif k >= low + i:
                    value[offset + k - low] += matrix[e]
    for t in range(blocks):
        low, first, last = begin[t], border_begin[t], border_begin[t + 1]
        size, width = begin[t + 1] - low, begin[t + 1] - low + last - first
        for i in range(size):
            offset = _row(at[t], width, i)
            own = value[offset + i : offset + width]
            own[0] = max(own[0], least * matrix[start[vertex[low + i]]])
            for j in range(i + 1, size):
                other = _row(at[t], width, j)
                part = own[j - i :]
                _subtract(value[other + j : other + width], part[0] / own[0], part)
            _divide(own[1:], own[0])
        # What remains of the equations of the border goes to the blocks that it lies in.
        above, k = parent[t], first
        while k < last:
            while border[k] >= begin[above + 1]:
                above = parent[above]
            high = begin[above + 1]
            size_above, e = high - begin[above], border_begin[above]
            width_above = size_above + border_begin[above + 1] - e
            for j in range(k, last):
                if border[j] < high:
                    local[j - first] = border[j] - begin[above]
                else:
                    while border[e] != border[j]:
                        e += 1
                    local[j - first] = size_above + e - border_begin[above]
            while k < last and border[k] < high:
                right = row[: last - k]
                for j in range(len(right)):
                    right[j] = 0.0
                for i in range(size):
                    offset = _row(at[t], width, i)
                    part = value[offset + size + k - first : offset + width]
                    _subtract(right, part[0] * value[offset + i], part)
                offset = _row(at[above], width_above, local[k - first])
                for j in range(len(right)):
                    value[offset + local[k - first + j]] += right[j]
                k += 1


@vectorized
def _substitute(
    vertex, position, begin, parent, border_begin, border, at, value, x,
    is_reached, is_negligible, negligible, row, lane, entry,
):  # fmt: skip
    """Solve for right sides x (k, LANES) in place, where they are not negligible.

    List the entries of the solution that are not, and return their number.
    """
    entries = 0
    blocks = len(parent)
    for t in range(blocks):
        if not is_reached[t]:
            continue
        is_reached[parent[t]] = True
        low, size, first = begin[t], begin[t + 1] - begin[t], border_begin[t]
        width = size + border_begin[t + 1] - first
        for i in range(size):
            offset = _row(at[t], width, i)
            for j in range(i + 1, width):
                k = low + j if j < size else border[first + j - size]
                for c in range(LANES):
                    x[k, c] -= value[offset + j] * x[low + i, c]
            for c in range(LANES):
                x[low + i, c] /= value[offset + i]
    for t in range(blocks - 1, -1, -1):
        low, size, first = begin[t], begin[t + 1] - begin[t], border_begin[t]
        width = size + border_begin[t + 1] - first
        if not is_reached[t]:
            largest = 0.0
            if not is_negligible[parent[t]]:
                for k in range(first, border_begin[t + 1]):
                    for c in range(LANES):
                        largest = max(largest, abs(x[border[k], c]))
            is_negligible[t] = largest <= negligible
            if is_negligible[t]:
                continue
        for i in range(size - 1, -1, -1):
            offset = _row(at[t], width, i)
            for j in range(i + 1, width):
                k = low + j if j < size else border[first + j - size]
                for c in range(LANES):
                    x[low + i, c] -= value[offset + j] * x[k, c]
            for c in range(LANES):
                if x[low + i, c] > negligible:
                    row[entries], lane[entries], entry[entries] = vertex[low + i], c, x[low + i, c]
                    entries += 1
    return entries
