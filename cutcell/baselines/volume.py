"""Weights that are smooth inside the body: bounded and unbounded biharmonic ones."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ..checks import check_integer, check_number
from ..rig import Rig
from .body import Body
from .result import BaselineBinding, MethodFailedError, finish

HANDLES = 5
"""Points on each bone that the weights are tied to: the middles of its fifths."""
SAME = 1e-6
"""Of the longest side: handles this near to each other or to the surface are one place."""
WORKER = Path(__file__).with_name("volume_worker.py")


def bbw(
    rig: Rig,
    *,
    leaf: str = "point",
    iterations: int = 8,
    limit: float = 120.0,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by bounded biharmonic weights, on tetrahedra that fill the body.

    TetGen needs a closed surface that does not cut itself; few real characters have one.
    Where it fails, crashes or takes too long, the result says so.

    Parameters
    ----------
    rig : Rig
    leaf
        See `bone_segments`.
    iterations : int
        Rounds of libigl's active set solver.
    limit : float
        Seconds after which to give up.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stage "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Jacobson, Baran, Popović & Sorkine 2011, "Bounded biharmonic weights for real-time
    deformation"; solver and mesher are those of libigl.
    """
    iterations = check_integer("iterations", iterations, 1, 10_000)
    return _bind(rig, "bbw", leaf, iterations, limit, max_influences, threshold)


def biharmonic(
    rig: Rig,
    *,
    leaf: str = "point",
    limit: float = 120.0,
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
        Stage "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Botsch & Kobbelt 2004, "An intuitive framework for real-time freeform modeling".
    """
    return _bind(rig, "biharmonic", leaf, 1, limit, max_influences, threshold)


def _bind(
    rig: Rig,
    method: str,
    leaf: str,
    iterations: int,
    limit: float,
    max_influences: int | None,
    threshold: float,
) -> BaselineBinding:
    limit = check_number("limit", limit, 0, 1e9)
    begin = perf_counter()
    body = Body.of(rig, leaf)
    try:
        weights = _solve(body, method, iterations, limit)
    except MethodFailedError as error:
        return BaselineBinding(None, {"weights": perf_counter() - begin}, failed=str(error))
    weights, warnings = finish(
        rig, body, weights, max_influences=max_influences, threshold=threshold
    )
    return BaselineBinding(weights, {"weights": perf_counter() - begin}, warnings)


def _solve(body: Body, method: str, iterations: int, limit: float) -> NDArray[np.float64]:
    """Return weights (k, j) of the body's places.

    Raises
    ------
    MethodFailedError
        There are none; the sentence says why.
    """
    if find_spec("igl") is None:
        raise MethodFailedError("libigl is not installed; try: pip install libigl")
    used, faces = np.unique(body.faces, return_inverse=True)
    handles, joint = _handles(body)
    names, column = np.unique(joint, return_inverse=True)
    job = {
        "points": body.points[used],
        "faces": faces.reshape(-1, 3),
        "handles": handles,
        "column": column,
        "method": method,
        "iterations": iterations,
    }
    found = _run(job, limit)
    weights = np.zeros((len(body.points), body.joints))
    weights[np.ix_(used, names)] = found
    return weights


def _handles(body: Body) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Spread points over the bones, each place once: positions (h, 3), joints (h,)."""
    spots = (np.arange(HANDLES) + 0.5) / HANDLES
    along = (body.bones.end - body.bones.start)[:, None]
    points = (body.bones.start[:, None] + spots[:, None] * along).reshape(-1, 3)
    joint = np.repeat(body.bones.joint, HANDLES)
    _, first = np.unique(np.round(points / SAME).astype(np.int64), axis=0, return_index=True)
    first.sort()
    return points[first], joint[first]


def _run(job: dict, limit: float) -> NDArray[np.float64]:
    with tempfile.TemporaryDirectory() as folder:
        job_path, result_path = Path(folder, "job.npz"), Path(folder, "result.npz")
        np.savez(job_path, **job)
        command = [sys.executable, str(WORKER), str(job_path), str(result_path)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=limit, check=False
            )
        except subprocess.TimeoutExpired:
            raise MethodFailedError(f"it took longer than {limit:g} seconds") from None
        if done.returncode != 0 or not result_path.exists():
            raise MethodFailedError(_last_words(done))
        with np.load(result_path) as result:
            if failed := str(result["failed"]):
                raise MethodFailedError(failed)
            return result["weights"]


def _last_words(done: subprocess.CompletedProcess) -> str:
    if done.returncode < 0:
        return f"TetGen crashed (signal {-done.returncode})"
    lines = done.stderr.strip().splitlines() or ["it said nothing"]
    return f"the solver stopped with exit code {done.returncode}: {lines[-1]}"
