"""Factors are those of the matrix, whatever its pattern; the order fills no more than others do."""

import numpy as np
import pytest
from scipy.sparse import coo_array, csr_array, eye_array, random_array
from scipy.sparse.linalg import splu

from cutcell.geometry.laplacian import cotangent_laplacian
from cutcell.weights.rig_falloff.lanes import RIGHT_SIDES
from cutcell.weights.rig_falloff.ldl import factorise, fill_reducing_ordering, substitute
from tests import meshes


def random_matrix(count=60, density=0.05, seed=0):
    half = random_array((count, count), density=density, rng=np.random.default_rng(seed))
    return positive(half + half.T)


def positive(matrix):
    """Outweigh the entries beside the diagonal."""
    weight = abs(matrix).sum(axis=1) + 1
    return csr_array(matrix + coo_array((weight, (np.arange(len(weight)),) * 2)))


PACE = np.zeros(2, np.int64)
MATRICES = {
    "mesh": lambda: of_mesh(*meshes.torus()),
    "random": random_matrix,
    "nearly full": lambda: random_matrix(30, 0.9),
    "many components": lambda: random_matrix(80, 0.008),
    "nothing but the diagonal": lambda: csr_array(2.0 * eye_array(5)),
    "a single unknown": lambda: csr_array([[3.0]]),
    "a star": lambda: positive(coo_array((-np.ones(18), star()), shape=(10, 10))),
    "none at all": lambda: csr_array((0, 0)),
}


def star():
    hub, ray = np.zeros(9, int), np.arange(1, 10)
    return np.concatenate([hub, ray]), np.concatenate([ray, hub])


def of_mesh(vertices, faces):
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    laplacian = cotangent_laplacian(vertices, faces[whole])
    return csr_array(laplacian + 0.01 * eye_array(len(vertices)))


def factorised(matrix):
    start, column = matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32)
    order = fill_reducing_ordering(start, column)
    return order, factorise(start, column, matrix.data, matrix.diagonal(), order, PACE)


@pytest.mark.parametrize("name", MATRICES)
def test_the_factors_make_up_the_matrix(name):
    matrix = MATRICES[name]()
    order, (begin, rows, values, pivots) = factorised(matrix)
    count = len(order)
    np.testing.assert_array_equal(np.sort(order), np.arange(count))
    below = np.zeros((count, count))
    below[rows, np.repeat(np.arange(count), np.diff(begin))] = values
    assert not np.triu(below).any()
    lower = below + np.eye(count)
    expected = matrix.toarray()[np.ix_(order, order)]
    np.testing.assert_allclose(lower * pivots @ lower.T, expected, atol=1e-12)


@pytest.mark.parametrize("name", MATRICES)
def test_many_right_sides_are_solved_at_once(name):
    matrix = MATRICES[name]()
    order, factors = factorised(matrix)
    right = np.random.default_rng(1).random((len(order), RIGHT_SIDES))
    right[:, 3] = 0
    found = right[order]
    substitute(*factors, found, PACE)
    expected = np.linalg.solve(matrix.toarray(), right)
    np.testing.assert_allclose(found, expected[order], atol=1e-9)


@pytest.mark.parametrize("mesh", sorted(meshes.ALL))
def test_the_order_fills_no_more_than_minimum_degree_does(mesh):
    matrix = of_mesh(*meshes.ALL[mesh]())
    values = factorised(matrix)[1][2]
    options = {"SymmetricMode": True}
    peer = splu(matrix.tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    assert len(values) <= 1.1 * (peer.L.nnz - matrix.shape[0])


def test_both_steps_can_be_stopped():
    matrix = random_matrix()
    order, factors = factorised(matrix)
    start, column = matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32)
    stop = np.array([5, 1])
    stopped = factorise(start, column, matrix.data, matrix.diagonal(), order, stop)
    assert stop[0] == 0
    assert not np.array_equal(stopped[2], factors[2])
    right = np.ones((len(order), RIGHT_SIDES))
    substitute(*factors, right, stop)
    assert (right == 1).all()
    assert ([2 * len(order), 0] == PACE).all() or PACE[0] == len(order) - 1
