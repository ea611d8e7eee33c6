"""Weights that are smooth inside the body: biharmonic ones and quasi-harmonic ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...isolated.run import LIMIT, WorkFailedError, run_isolated
from ...method import PAPER, Leaf
from ...rig.checks import check_integer, check_number
from ...rig.rig import Rig
from ..body import Body
from ..frame import BaselineBinding, Run, bind_by
from .tetrahedra import tetrahedra

SOLVERS = {
    "bbw": "libigl's solver",
    "biharmonic": "the linear solver",
    "quasi_harmonic": "the descent",
}


def bbw(
    rig: Rig,
    *,
    leaf: Leaf = "point",
    iterations: int = 8,
    limit: float = LIMIT,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by bounded biharmonic weights, on tetrahedra that fill the body.

    TetGen fills the body; where it cannot (few real characters are closed and do not cut
    themselves), fTetWild does. Where a library fails, crashes or takes too long, the result
    has failed.

    Parameters
    ----------
    rig : Rig
    leaf
        See `bone_segments`.
    iterations : int
        Rounds of libigl's active set solver.
    limit : float
        Seconds that each mesher, and the solver, may take.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stages "tetrahedra", "weights"; the start of processes does not count.

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Jacobson, Baran, Popović & Sorkine 2011, "Bounded biharmonic weights for real-time
    deformation"; Hu et al. 2020, "Fast tetrahedral meshing in the wild". The solver is
    libigl's.
    """
    iterations = check_integer("iterations", iterations, 1, 10_000)
    return _bind(rig, "bbw", leaf, iterations, limit, max_influences, threshold)


def biharmonic(
    rig: Rig,
    *,
    leaf: Leaf = "point",
    limit: float = LIMIT,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by biharmonic weights without bounds: one linear system, negative weights dropped.

    Parameters
    ----------
    rig, leaf, limit, max_influences, threshold
        See `bbw`.

    Returns
    -------
    BaselineBinding
        Stages "tetrahedra", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Botsch & Kobbelt 2004, "An intuitive framework for real-time freeform modeling".
    """
    return _bind(rig, "biharmonic", leaf, 0, limit, max_influences, threshold)


def quasi_harmonic(
    rig: Rig,
    *,
    leaf: Leaf = "point",
    iterations: int = 4,
    limit: float = LIMIT,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by quasi-harmonic weights: bounded by nature, nearly as smooth as biharmonic ones.

    Parameters
    ----------
    rig : Rig
    leaf
        See `bone_segments`.
    iterations : int
        Steps of the descent in each of its five rounds.
    limit, max_influences, threshold
        See `bbw`.

    Returns
    -------
    BaselineBinding
        Stages "tetrahedra", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Wang & Solomon 2021, "Fast quasi-harmonic weights for geometric data interpolation".
    """
    iterations = check_integer("iterations", iterations, 0, 10_000)
    return _bind(rig, "quasi_harmonic", leaf, iterations, limit, max_influences, threshold)


def _bind(
    rig: Rig,
    solver: str,
    leaf: Leaf,
    iterations: int,
    limit: float,
    max_influences: int | None,
    threshold: float,
) -> BaselineBinding:
    limit = check_number("limit", limit, 0, 1e9)
    method = PAPER.with_options(leaf=leaf, max_influences=max_influences, threshold=threshold)

    def solve(body: Body, run: Run) -> NDArray[np.float64]:
        filled, failed, seconds = tetrahedra(body, limit)
        run.end("tetrahedra", seconds)
        if filled is None:
            raise WorkFailedError(failed)
        run.warnings += filled.warnings
        names, column = np.unique(filled.joint, return_inverse=True)
        job = {
            "nodes": filled.nodes,
            "tets": filled.tets,
            "handles": filled.handles,
            "column": column,
            "iterations": iterations,
        }
        try:
            result = run_isolated(solver, job, limit, SOLVERS[solver])
        except WorkFailedError:
            run.end("weights")
            raise
        run.end("weights", float(result["seconds"]))  # the start of its process does not count
        weights = np.zeros((len(body.points), body.joints))
        on_surface = np.einsum("kc,kcj->kj", filled.shares, result["weights"][filled.corners])
        weights[np.ix_(filled.used, names)] = on_surface
        return weights

    return bind_by(solve, rig, method)
