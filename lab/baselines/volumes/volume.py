"""Weights that are smooth inside the body: biharmonic ones and quasi-harmonic ones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_integer, check_number
from cutcell.isolated.run import LIMIT, WorkFailedError, run_isolated
from cutcell.method import PAPER, Leaf
from cutcell.rig import Rig

from ..body import Body, Same
from ..frame import BaselineBinding, Run, bind_by

TASKS = {
    "tetgen": "tetrahedra:by_tetgen",
    "tetwild": "tetrahedra:by_tetwild",
    "bbw": "smooth:bounded",
    "biharmonic": "smooth:unbounded",
    "quasi_harmonic": "quasi_harmonic:quasi_harmonic",
}
"""Module of `cutcell_lab.isolated` and function."""
SOLVERS = {
    "bbw": "libigl's solver",
    "biharmonic": "the linear solver",
    "quasi_harmonic": "the descent",
}


HANDLES = 5
"""Points on each bone that the weights are tied to: the middles of its fifths."""
SAME = 1e-6
"""Distance, relative to the longest side, at which handles and surface points merge."""
EDGE = 0.05
"""Length of edges that fTetWild aims at, relative to the diagonal; its default."""


@dataclass(frozen=True, eq=False)
class Tetrahedra:
    """Tetrahedra that fill a body.

    The vertices `used` of the body are means of the nodes `corners`, weighted by `shares`.
    """

    nodes: NDArray[np.float64]  # (n, 3)
    tets: NDArray[np.int64]  # (t, 4)
    corners: NDArray[np.int64]  # (k, 4)
    shares: NDArray[np.float64]  # (k, 4)
    used: NDArray[np.int32]  # (k,), welded vertices with faces
    handles: NDArray[np.float64]  # (h, 3), points on the bones
    joint: NDArray[np.int32]  # (h,), of each handle
    warnings: tuple[str, ...]


def tetrahedra(body: Body, limit: float) -> tuple[Tetrahedra | None, str, float]:
    """Fill a body: by TetGen, or else by fTetWild. The last one filled is remembered.

    TetGen needs a closed surface that does not cut itself; few real characters have one.
    """
    return _fill(Same(body, limit))


def _isolated(task: str, job: dict[str, Any], limit: float, who: str) -> dict[str, Any]:
    name = f"cutcell_lab.isolated.{TASKS[task]}"
    return run_isolated(name, job, limit, who, extra="cutcell[copyleft]")


@lru_cache(maxsize=2)
def _fill(key: Same) -> tuple[Tetrahedra | None, str, float]:
    body, limit = key.body, key.option
    begin = perf_counter()
    used, faces = np.unique(body.faces, return_inverse=True)
    handles, joint = _handles(body)
    job = {"points": body.points[used], "faces": faces.reshape(-1, 3), "handles": handles}
    warnings: tuple[str, ...] = ()
    try:
        mesh = _isolated("tetgen", job, limit, "TetGen")
    except WorkFailedError as first:
        try:
            mesh = _isolated("tetwild", job | {"edge": EDGE}, limit, "fTetWild")
        except WorkFailedError as second:
            return None, f"{first}; {second}", perf_counter() - begin
        warnings = (f"{first}; fTetWild filled it, nearly",)
    seconds = perf_counter() - begin
    filled = Tetrahedra(
        nodes=mesh["nodes"],
        tets=mesh["tets"],
        corners=mesh["corners"],
        shares=mesh["shares"],
        used=used,
        handles=handles,
        joint=joint,
        warnings=warnings,
    )
    return filled, "", seconds


def _handles(body: Body) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Spread points over the bones, none of them twice: positions (h, 3), joints (h,)."""
    spots = (np.arange(HANDLES) + 0.5) / HANDLES
    along = (body.bones.end - body.bones.start)[:, None]
    points = (body.bones.start[:, None] + spots[:, None] * along).reshape(-1, 3)
    joint = np.repeat(body.bones.joint, HANDLES)
    _, first = np.unique(np.round(points / SAME).astype(np.int64), axis=0, return_index=True)
    first.sort()
    return points[first], joint[first]


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
            result = _isolated(solver, job, limit, SOLVERS[solver])
        except WorkFailedError:
            run.end("weights")
            raise
        run.end("weights", float(result["seconds"]))  # the start of its process does not count
        weights = np.zeros((len(body.points), body.joints))
        on_surface = np.einsum("kc,kcj->kj", filled.shares, result["weights"][filled.corners])
        weights[np.ix_(filled.used, names)] = on_surface
        return weights

    return bind_by(solve, rig, method)
