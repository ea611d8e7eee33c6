"""Weights inside tetrahedra that are as smooth as can be: biharmonic, with bounds and without."""

from __future__ import annotations

import igl
import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree


def bounded(nodes, tets, handles, column, iterations):
    """Compute bounded biharmonic weights, by libigl's active set solver.

    Shapes: nodes (n, 3), tets (t, 4), handles (h, 3), column (h,).
    """
    fixed, values = constraints(cKDTree(nodes), handles, column)
    return {"weights": igl.bbw(nodes, tets, fixed, values, max_iter=int(iterations))}


def unbounded(nodes, tets, handles, column, iterations=0):
    """Compute biharmonic weights: the same energy without bounds, by one linear system."""
    del iterations
    fixed, values = constraints(cKDTree(nodes), handles, column)
    energy = smoothness(nodes, tets)
    free = np.setdiff1d(np.arange(len(nodes)), fixed)
    weights = np.zeros((len(nodes), values.shape[1]))
    weights[fixed] = values
    right = -(energy[free][:, fixed] @ values)
    weights[free] = splu(energy[free][:, free].tocsc()).solve(right)
    return {"weights": weights}


def smoothness(nodes, tets):
    """Return the matrix (n, n) of the energy that is zero where the Laplacian is zero."""
    stiffness = igl.cotmatrix(nodes, tets)
    mass = igl.massmatrix(nodes, tets, igl.MASSMATRIX_TYPE_DEFAULT).diagonal()
    return (stiffness @ diags(1 / np.maximum(mass, 1e-300)) @ stiffness).tocsr()


def constraints(tree, handles, column):
    """Return the nodes that are held (f,), and their weights (f, c): one of a row is 1.

    A handle outside the tetrahedra holds the node nearest to it, unless another has it.
    """
    away, node = tree.query(handles)
    order = np.argsort(away, kind="stable")
    fixed, first = np.unique(node[order], return_index=True)
    values = np.zeros((len(fixed), column.max() + 1))
    values[np.arange(len(fixed)), column[order][first]] = 1
    return fixed, values
