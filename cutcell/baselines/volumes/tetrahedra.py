"""Tetrahedra that fill a body, with points along the bones among their nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ...isolated.run import WorkFailedError, run_isolated
from ..body import Body, Same

HANDLES = 5
"""Points on each bone that the weights are tied to: the middles of its fifths."""
SAME = 1e-6
"""Of the longest side: handles this near to each other or to the surface are one point."""
EDGE = 0.05
"""Of the diagonal: edges that fTetWild aims at, its own default."""


@dataclass(frozen=True, eq=False)
class Tetrahedra:
    """Tetrahedra that fill a body.

    Parameters
    ----------
    nodes, tets : arrays, shapes (n, 3), (t, 4)
    corners, shares : arrays, shape (k, 4)
        Each welded vertex that faces use is the mean of the nodes `corners`, weighted by `shares`.
    used : array, shape (k,)
        These vertices in the body.
    handles, joint : arrays, shapes (h, 3), (h,)
        Points on the bones, and their joints.
    warnings : tuple of str
    """

    nodes: NDArray[np.float64]
    tets: NDArray[np.int64]
    corners: NDArray[np.int64]
    shares: NDArray[np.float64]
    used: NDArray[np.int32]
    handles: NDArray[np.float64]
    joint: NDArray[np.int32]
    warnings: tuple[str, ...]


def tetrahedra(body: Body, limit: float) -> tuple[Tetrahedra | None, str, float]:
    """Fill a body: by TetGen, or else by fTetWild. The last one filled is remembered.

    TetGen needs a closed surface that does not cut itself; few real characters have one.
    """
    return _fill(Same(body, limit))


@lru_cache(maxsize=2)
def _fill(key: Same) -> tuple[Tetrahedra | None, str, float]:
    body, limit = key.body, key.option
    begin = perf_counter()
    used, faces = np.unique(body.faces, return_inverse=True)
    handles, joint = _handles(body)
    job = {"points": body.points[used], "faces": faces.reshape(-1, 3), "handles": handles}
    warnings: tuple[str, ...] = ()
    try:
        mesh = run_isolated("tetgen", job, limit, "TetGen")
    except WorkFailedError as first:
        try:
            mesh = run_isolated("tetwild", job | {"edge": EDGE}, limit, "fTetWild")
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
