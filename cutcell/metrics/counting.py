"""Weight of each vertex in a mean over the mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ParameterError
from ..geometry.weld import WELD_TOLERANCE, weld
from ..rig import TriangleMesh
from ..rig.checks import check_choice

COUNTS = ("welded", "vertices")


def vertex_shares(mesh: TriangleMesh, count: str = "welded") -> NDArray[np.float64]:
    """Return each vertex's share of a mean over the mesh.

    Exporters split a vertex at every texture seam. Counted as they are in the file, seams
    would weigh two and three times as much as the skin between them.

    Parameters
    ----------
    mesh : TriangleMesh
    count : {"welded", "vertices"}
        "welded": every welded vertex counts once, the file's vertices share it evenly.
        "vertices": every vertex of the file counts the same. Vertices that no face uses count
        nothing.

    Returns
    -------
    array, shape (n,), float64
        Sums to one.

    Raises
    ------
    ParameterError
        An unknown `count`.
    """
    check_choice("count", count, COUNTS)
    share = np.zeros(len(mesh.vertices))
    used = np.unique(mesh.faces)
    share[used] = 1.0
    if count == "welded":
        low, high = mesh.bounds
        welded = weld(mesh.vertices[used], WELD_TOLERANCE * float((high - low).max()))[1]
        share[used] = 1.0 / np.bincount(welded)[welded]
    return share / share.sum()


def checked_shares(shares: ArrayLike | None, count: int) -> NDArray[np.float64]:
    """Return shares of `count` vertices that sum to one; even ones for None."""
    if shares is None:
        return np.full(count, 1.0 / count)
    array = np.asarray(shares, np.float64)
    if array.shape != (count,):
        raise ParameterError(f"shares have the shape {array.shape}, expected ({count},)")
    if not (np.isfinite(array) & (array >= 0)).all() or array.sum() == 0:
        raise ParameterError("shares must be finite, not negative, and not all zero")
    return array / array.sum()
