"""Matches of vertices with points of a character's surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...graph import CutCellGraph
from ...rig import Rig, TriangleMesh
from ...runtime.progress import Progress
from .closest import Surface

SAMPLES_PER_RADIUS = 8
"""Samples of the source along the greatest distance of a match."""


MIN_SAMPLED = 0.01
"""Part of the longest side: the source is sampled as for this distance, at the closest."""


class Matches(NamedTuple):
    """Matches of the welded vertices of a mesh.

    Parameters
    ----------
    weights : array, shape (k, j), float64
        Of the closest point; rows sum to one.
    state : array, shape (k,), uint8
    distance : array, shape (k,), float64
        In the source's units.
    resolved : array, shape (k,), bool
    """

    weights: NDArray[np.float64]
    state: NDArray[np.uint8]
    distance: NDArray[np.float64]
    resolved: NDArray[np.bool_]


def match(
    source: Rig,
    target: TriangleMesh,
    distance: float,
    angle: float,
    flipped: bool,
    graph: CutCellGraph | None,
    progress: Progress,
) -> Matches:
    """Match the welded vertices of a target; see `transfer` for the parameters."""
    cube, mesh = source.mesh.cube, source.mesh.welded
    welded = target.welded
    points = cube.to_unit(target.vertices[welded.first])
    radius = distance * cube.diagonal
    count = len(points)
    rows = _welded_rows(source)
    patch = np.zeros(len(rows), np.intp)
    surface = Surface(
        mesh, np.asarray(rows.any(axis=1)), patch, max(radius, MIN_SAMPLED) / SAMPLES_PER_RADIUS
    )
    cosine = float(np.cos(np.radians(angle)))
    matches = surface.candidates(points, welded.normals, radius, cosine, flipped)
    chosen = matches.subset(np.append(True, np.diff(matches.point) > 0)[: len(matches.point)])
    matched = np.zeros(count, np.bool_)
    matched[chosen.point] = True
    has_match = np.bincount(welded.component, matched, welded.component.max() + 1) > 0
    lost = np.flatnonzero(~has_match[welded.component])
    state = np.where(matched, 0, 1).astype(np.uint8)
    state[lost] = 2
    away = np.full(count, np.inf)
    away[chosen.point] = chosen.distance
    weights = np.zeros((count, rows.shape[1]))
    weights[chosen.point] = surface.at(rows, chosen)
    if len(lost):
        anywhere = surface.nearest(points[lost])
        weights[lost], away[lost] = surface.at(rows, anywhere), anywhere.distance
    return Matches(weights, state, away * cube.size, np.zeros(count, np.bool_))


def _welded_rows(source: Rig) -> NDArray[np.float64]:
    """Return the mean weights of the source at each welded vertex (k, j); of those with any."""
    index, weights = source.mesh.welded.index, source.weights
    assert weights is not None
    rows = np.zeros((len(source.mesh.welded.points), weights.shape[1]))
    np.add.at(rows, index, weights)
    total = rows.sum(axis=1, keepdims=True)
    return np.divide(rows, total, out=rows, where=total > 0)
