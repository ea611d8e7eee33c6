"""Weights on tetrahedra, in a process of its own: TetGen may crash or never end.

    python volume_worker.py JOB.npz RESULT.npz

The job holds `points` (k, 3), `faces` (m, 3), `handles` (h, 3), `column` (h,) and the
method; the result holds `weights` (k, c), one column for each number in `column`, or what
went wrong in `failed`. Run by `volume.solve_in_volume`; knows nothing of the rest.
"""

from __future__ import annotations

import sys

import igl
import numpy as np
from igl.copyleft import tetgen
from scipy.sparse import diags
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

SAME = 1e-6
"""Of the longest side: nodes of the tetrahedra this near to a point are that point."""
FLAGS = "pq1.5YQ"
"""TetGen: keep the surface as it is, make well-shaped tetrahedra, say nothing."""


def main(job_path: str, result_path: str) -> None:
    """Read a job, do it, write its result."""
    job = np.load(job_path)
    try:
        weights = _solve(job)
        np.savez(result_path, weights=weights, failed="")
    except (RuntimeError, ValueError) as error:
        np.savez(result_path, weights=np.zeros((0, 0)), failed=str(error))


def _solve(job):
    points, faces, handles = job["points"], job["faces"].astype(np.int64), job["handles"]
    nodes, tets = tetrahedralize(points, faces, handles)
    tree = cKDTree(nodes)
    away, home = tree.query(points)
    if (away > SAME).any():
        raise RuntimeError(
            f"TetGen dropped {(away > SAME).sum()} of the {len(points)} places of the surface"
        )
    fixed, values = constraints(tree, handles, job["column"])
    solve = {"bbw": bounded, "biharmonic": unbounded}[str(job["method"])]
    return solve(nodes, tets, fixed, values, int(job["iterations"]))[home]


def tetrahedralize(points, faces, handles):
    """Fill a closed surface with tetrahedra that have the handles among their nodes."""
    try:
        result = tetgen.tetrahedralize(np.concatenate([points, handles]), faces, flags=FLAGS)
    except RuntimeError:
        raise RuntimeError(
            "TetGen cannot fill the surface: it is open, cuts itself, or encloses nothing"
        ) from None
    nodes, tets = result[0], result[1]
    if len(tets) == 0:
        raise RuntimeError("TetGen found nothing inside the surface")
    used = np.unique(tets)
    number = np.full(len(nodes), -1)
    number[used] = np.arange(len(used))
    return np.ascontiguousarray(nodes[used]), np.ascontiguousarray(number[tets])


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


def bounded(nodes, tets, fixed, values, iterations):
    """Bounded biharmonic weights, by libigl's active set solver."""
    return igl.bbw(nodes, tets, fixed, values, max_iter=iterations)


def unbounded(nodes, tets, fixed, values, _iterations):
    """Biharmonic weights: the same energy without bounds, by one linear system."""
    stiffness = igl.cotmatrix(nodes, tets)
    mass = igl.massmatrix(nodes, tets, igl.MASSMATRIX_TYPE_DEFAULT).diagonal()
    energy = (stiffness @ diags(1 / np.maximum(mass, 1e-300)) @ stiffness).tocsr()
    free = np.setdiff1d(np.arange(len(nodes)), fixed)
    weights = np.zeros((len(nodes), values.shape[1]))
    weights[fixed] = values
    right = -(energy[free][:, fixed] @ values)
    weights[free] = splu(energy[free][:, free].tocsc()).solve(right)
    return weights


if __name__ == "__main__":
    main(*sys.argv[1:])
