"""Sparse rows equal a dense matrix in which absent values are infinite."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from cutcell.rig import rows as sparse_rows


@pytest.fixture(params=[0.0, 0.4, 1.0])
def dense(request):
    random = np.random.default_rng(5)
    values = np.rint(random.random((30, 7)) * 4)  # with zeros, and with equals
    values[random.random(values.shape) < request.param] = np.inf
    values[3] = np.inf
    return values


def test_zeros_are_values_and_infinities_absent(dense):
    rows = sparse_rows.from_dense(dense)
    assert rows.nnz == np.isfinite(dense).sum()
    assert rows.has_sorted_indices
    np.testing.assert_array_equal(sparse_rows.to_dense(rows), dense)


def test_the_least_of_each_row_and_its_first_column(dense):
    rows = sparse_rows.from_dense(dense)
    np.testing.assert_array_equal(sparse_rows.least(rows), dense.min(axis=1))
    np.testing.assert_array_equal(sparse_rows.column_of_least(rows), dense.argmin(axis=1))


def test_values_are_looked_up(dense):
    rows = sparse_rows.from_dense(dense)
    row, column = np.indices(dense.shape)
    np.testing.assert_array_equal(sparse_rows.lookup(rows, row, column), dense)
    assert sparse_rows.lookup(rows, np.array(29), np.array(6)) == dense[29, 6]


def test_rows_entries_and_columns_are_chosen(dense):
    rows = sparse_rows.from_dense(dense)
    small = sparse_rows.chosen_entries(rows, rows.data < 2)
    np.testing.assert_array_equal(sparse_rows.to_dense(small), np.where(dense < 2, dense, np.inf))
    wide = sparse_rows.to_dense(sparse_rows.with_columns(rows, np.arange(7) * 2, 13))
    np.testing.assert_array_equal(wide[:, ::2], dense)
    assert np.isinf(wide[:, 1::2]).all()
    mixed = sparse_rows.with_rows(rows, np.array([8, 2]), rows[[0, 3]])
    expected = dense.copy()
    expected[[8, 2]] = dense[[0, 3]]
    np.testing.assert_array_equal(sparse_rows.to_dense(mixed), expected)


def test_weights_are_scaled_and_their_largest_found():
    random = np.random.default_rng(6)
    dense = np.rint(random.random((30, 7)) * 4) * (random.random((30, 7)) < 0.5)
    rows = csr_array(dense)
    np.testing.assert_array_equal(sparse_rows.strongest(rows), dense.argmax(axis=1))
    factor = random.random(30)
    scaled = sparse_rows.scaled(rows, factor).toarray()
    np.testing.assert_array_equal(scaled, dense * factor[:, None])
    column = dense.argmax(axis=1)
    np.testing.assert_array_equal(sparse_rows.single(column, 7).toarray(), np.eye(7)[column])
