"""Quasi-harmonic weights (Wang & Solomon 2021).

Solutions of div(A grad w) = 0 obey the maximum principle and sum to one whatever the field A
of positive definite tensors is. So A is sought that makes the weights as smooth as biharmonic
ones are: no bounds need to be enforced, and each step is linear systems with one matrix.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from .smooth import constraints, smoothness

ROUNDS = 5
"""Times that the descent starts again, with half the step (their section 6.1)."""
STEP = 0.1
"""Step of the first round; tensors start as the identity."""
ROUND = 0.2
"""Part of each tensor that is the same in all directions: bounds its condition number."""
MOMENTUM, VARIANCE = 0.9, 0.999
LOWER = np.tril(np.ones((3, 3)))


def quasi_harmonic(nodes, tets, handles, column, iterations):
    """Compute weights by descent on the tensors.

    Parameters
    ----------
    nodes, tets, handles, column
        See `smooth.bounded`.
    iterations : int
        Steps in each of the rounds; with none, the weights are harmonic.

    Returns
    -------
    dict
        `weights` (n, c); `energy` (steps + 1,) of the weights before, between and after.
    """
    fixed, values = constraints(cKDTree(nodes), handles, column)
    problem = Problem(nodes, tets, fixed, values)
    factor = np.tile(np.eye(3), (len(tets), 1, 1))
    weights, energy, slope = problem.evaluate(factor)
    best, energies = weights, [energy]
    for turn in range(ROUNDS):
        mean, square = np.zeros_like(factor), np.zeros_like(factor)
        for step in range(1, int(iterations) + 1):
            mean = MOMENTUM * mean + (1 - MOMENTUM) * slope
            square = VARIANCE * square + (1 - VARIANCE) * slope**2
            size = np.sqrt(square / (1 - VARIANCE**step)) + 1e-300
            factor = factor - STEP / 2**turn * (mean / (1 - MOMENTUM**step)) / size
            weights, energy, slope = problem.evaluate(factor)
            if energy < min(energies):
                best = weights
            energies.append(energy)
    return {"weights": best, "energy": np.array(energies)}


class Problem:
    """The energy of weights as a function of the tensors' Cholesky factors."""

    def __init__(self, nodes, tets, fixed, values):
        self.tets, self.fixed, self.values, self.count = tets, fixed, values, len(nodes)
        self.free = np.setdiff1d(np.arange(len(nodes)), fixed)
        sides = nodes[tets[:, 1:]] - nodes[tets[:, :1]]
        self.volume = np.abs(np.linalg.det(sides)) / 6
        three = np.swapaxes(np.linalg.inv(sides), 1, 2)
        self.slopes = np.concatenate([-three.sum(axis=1, keepdims=True), three], axis=1)
        self.smoothness = smoothness(nodes, tets)

    def tensors(self, factor):
        """Return A (t, 3, 3) of lower triangular factors."""
        tensor = factor @ np.swapaxes(factor, 1, 2)
        return tensor + ROUND * np.trace(tensor, axis1=1, axis2=2)[:, None, None] * np.eye(3)

    def evaluate(self, factor):
        """Return the weights (n, c), their energy, and its derivative by the factors."""
        parts = np.einsum("tax,txy,tby->tab", self.slopes, self.tensors(factor), self.slopes)
        parts *= self.volume[:, None, None]
        rows, columns = np.repeat(self.tets, 4, axis=1), np.tile(self.tets, (1, 4))
        entries = (parts.ravel(), (rows.ravel(), columns.ravel()))
        stiffness = coo_array(entries, shape=(self.count,) * 2).tocsr()
        system = splu(
            stiffness[self.free][:, self.free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            options={"SymmetricMode": True},
            diag_pivot_thresh=0.0,
        )
        weights = np.zeros((self.count, self.values.shape[1]))
        weights[self.fixed] = self.values
        weights[self.free] = system.solve(-(stiffness[self.free][:, self.fixed] @ self.values))
        bent = self.smoothness @ weights
        energy = float((weights * bent).sum() / 2)
        # The adjoint: dE/dA = -(grad of it) (grad of w), summed over the weights.
        adjoint = np.zeros_like(weights)
        adjoint[self.free] = system.solve(bent[self.free])
        by_tensor = np.zeros_like(factor)
        for one in range(weights.shape[1]):
            a = np.einsum("tax,ta->tx", self.slopes, adjoint[self.tets, one])
            w = np.einsum("tax,ta->tx", self.slopes, weights[self.tets, one])
            by_tensor -= a[:, :, None] * w[:, None, :]
        by_tensor *= self.volume[:, None, None]
        by_tensor = (by_tensor + np.swapaxes(by_tensor, 1, 2)) / 2
        same = ROUND * np.trace(by_tensor, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        return weights, energy, 2 * (by_tensor + same) @ factor * LOWER
