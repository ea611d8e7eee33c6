"""Sparse rows: for each vertex its few joints, ascending, each with a weight or a distance.

A distance may be zero, and is infinite where there is none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from ..geometry.vectors import TIE


def rows_of_entries(rows: csr_array) -> NDArray[np.intp]:
    """Return the row of each entry."""
    return np.repeat(np.arange(rows.shape[0]), np.diff(rows.indptr))


def from_dense(values: NDArray[np.float64]) -> csr_array:
    """Return rows (p, j) of the finite values."""
    row, column = np.nonzero(np.isfinite(values))
    start = np.searchsorted(row, np.arange(len(values) + 1))
    return csr_array((values[row, column], column, start), values.shape)


def to_dense(rows: csr_array) -> NDArray[np.float64]:
    """Return the values of rows (p, j), infinite where there are none."""
    values = np.full(rows.shape, np.inf)
    values[rows_of_entries(rows), rows.indices] = rows.data
    return values


def lookup(
    rows: csr_array, row: NDArray[np.integer], column: NDArray[np.integer]
) -> NDArray[np.float64]:
    """Return the values in some rows and columns, broadcast; infinite where there are none."""
    place = rows_of_entries(rows) * rows.shape[1] + rows.indices
    wanted = np.asarray(row * rows.shape[1] + column)
    entry = np.searchsorted(place, wanted)
    has_value = np.append(place, -1)[entry] == wanted
    return np.where(has_value, np.append(rows.data, np.inf)[entry], np.inf)


def chosen_entries(rows: csr_array, which: NDArray[np.bool_]) -> csr_array:
    """Return rows with only some of their entries, `which` (e,)."""
    start = np.append(0, np.cumsum(which))[rows.indptr]
    return csr_array((rows.data[which], rows.indices[which], start), rows.shape)


def with_columns(rows: csr_array, number: NDArray[np.integer], columns: int) -> csr_array:
    """Return rows whose columns have other numbers, ascending too, among more columns."""
    return csr_array((rows.data, number[rows.indices], rows.indptr), (rows.shape[0], columns))


def least(rows: csr_array) -> NDArray[np.float64]:
    """Return the least value of each row, infinite for none, (p,)."""
    result = np.full(rows.shape[0], np.inf)
    has_any = np.flatnonzero(np.diff(rows.indptr))
    if len(has_any):
        result[has_any] = np.minimum.reduceat(rows.data, rows.indptr[has_any])
    return result


def column_of_least(rows: csr_array) -> NDArray[np.intp]:
    """Return the column of the least value of each row, the first of equals, 0 for none."""
    row, column = rows_of_entries(rows), np.zeros(rows.shape[0], np.intp)
    is_least = rows.data == least(rows)[row]
    column[row[is_least][::-1]] = rows.indices[is_least][::-1]  # the first one is written last
    return column


def scaled(rows: csr_array, factor: NDArray[np.float64]) -> csr_array:
    """Multiply each row (n, j) by its factor (n,)."""
    data = rows.data * np.repeat(factor, np.diff(rows.indptr))
    return csr_array((data, rows.indices, rows.indptr), rows.shape)


def with_rows(rows: csr_array, which: NDArray[np.integer], others: csr_array) -> csr_array:
    """Return rows of which some, by number, are replaced by others."""
    number = np.arange(rows.shape[0])
    number[which] = rows.shape[0] + np.arange(len(which))
    return csr_array(vstack([rows, others], format="csr")[number])


def single(joint: NDArray[np.integer], joints: int) -> csr_array:
    """Return rows with all weight on one joint each, given by number."""
    return csr_array((np.ones(len(joint)), joint, np.arange(len(joint) + 1)), (len(joint), joints))


def strongest(rows: csr_array) -> NDArray[np.intp]:
    """Return the joint with the largest weight of each row, the first of equals, 0 for none."""
    row = rows_of_entries(rows)
    most = rows.max(axis=1).toarray()
    is_largest = rows.data >= most[row] * (1 - TIE)
    joint = np.zeros(rows.shape[0], np.intp)
    joint[row[is_largest][::-1]] = rows.indices[is_largest][::-1]  # the first one is written last
    return joint
