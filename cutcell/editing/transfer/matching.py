"""Matches of vertices with points of a character's surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import WeightsError
from ...geometry.vectors import TIE
from ...graph import build_graph
from ...rig import Rig, TriangleMesh
from ...runtime.progress import Progress
from .closest import Surface
from .through import alternatives, landmark_distances, resolve

NEAR, TOUCHING = 0.3, 0.05
"""Parts of the greatest distance within which normals need not agree: the first if they agree on at
least half of the component, like those of thick cloth with an inside and hems, else the second."""
RESOLUTION = 64
"""Of the graph that distances through the body are measured in."""
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
    progress: Progress,
) -> Matches:
    """Match the welded vertices of a target; see `transfer` for the parameters."""
    cube, mesh = source.mesh.cube, source.mesh.welded
    welded = target.welded
    points = cube.to_unit(target.vertices[welded.first])
    radius = distance * cube.diagonal
    rows = _welded_rows(source)
    weighted = np.asarray(rows.any(axis=1))
    faces = mesh.faces[mesh.is_whole & weighted[mesh.faces].all(axis=1)]
    if not len(faces):
        raise WeightsError("no triangle of the source has weights at all corners; bind it first")
    graph = build_graph(source.mesh, RESOLUTION, progress=progress)
    place = landmark_distances(graph, graph.vertex_node[mesh.first], weighted)
    surface = Surface(mesh, faces, max(radius, MIN_SAMPLED) / SAMPLES_PER_RADIUS)
    closest = surface.nearest(points)
    every = alternatives(surface, points, closest, place, radius, NEAR * radius)
    choice, resolved = resolve(
        every, surface.at(place, every), surface.at(surface.mesh.points, every), welded, radius
    )
    chosen = every.subset(choice)
    cosine = float(np.cos(np.radians(angle)))
    fits = chosen.distance <= radius
    fits &= _agree(surface.at(mesh.normals, chosen), welded.normals, cosine, flipped)
    component = welded.component
    fitting = np.bincount(component, welded.areas * fits)
    is_along = fitting >= (0.5 - TIE) * np.bincount(component, welded.areas)
    near = np.where(is_along, NEAR, TOUCHING)[component] * radius
    matched = fits | (chosen.distance <= near)
    has_match = np.bincount(component, matched) > 0
    state = np.where(matched, 0, np.where(has_match[component], 1, 2)).astype(np.uint8)
    away = chosen.distance * cube.size
    return Matches(surface.at(rows, chosen), state, away, resolved)


def _agree(
    one: NDArray[np.float64], other: NDArray[np.float64], cosine: float, flipped: bool
) -> NDArray[np.bool_]:
    """Return whether normals (k, 3) are alike; one of length zero is like any."""
    size = np.linalg.norm(one, axis=1) * np.linalg.norm(other, axis=1)
    product = np.einsum("px,px->p", one, other)
    product = np.abs(product) if flipped else product
    return np.asarray(product >= cosine * size - TIE)


def _welded_rows(source: Rig) -> NDArray[np.float64]:
    """Return the mean weights of the source at each welded vertex (k, j); of those with any."""
    index, weights = source.mesh.welded.index, source.weights
    assert weights is not None
    rows = np.zeros((len(source.mesh.welded.points), weights.shape[1]))
    np.add.at(rows, index, weights)
    total = rows.sum(axis=1, keepdims=True)
    return np.divide(rows, total, out=rows, where=total > 0)
