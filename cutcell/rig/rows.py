"""Rows of weights: for each vertex its few joints, ascending, and their weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from ..geometry.vectors import TIE


def rows_of_entries(rows: csr_array) -> NDArray[np.intp]:
    """Return the row of each entry."""
    return np.repeat(np.arange(rows.shape[0]), np.diff(rows.indptr))


def with_data(rows: csr_array, data: NDArray[np.float64]) -> csr_array:
    """Return rows with other values of their entries (e,); zeros are left out."""
    result = csr_array((data, rows.indices.copy(), rows.indptr.copy()), rows.shape)
    result.eliminate_zeros()
    return result


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
