"""Which of several matches is right: the one that is near to its neighbours' through the body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from ...geometry.vectors import TIE
from ...geometry.welded import WeldedMesh
from ...graph import CutCellGraph
from .closest import Points, Surface

LANDMARKS = 24
"""Vertices of the body that distances are measured from."""
UNCONNECTED = 2.0
"""Distance, in longest sides, of what no path leads to."""
DETOUR, MIN_DETOUR = 2.0, 0.02
"""Two points are in different parts of the body if the way through it is this many times as long as
the straight line, and longer by this part of the longest side."""


def landmark_distances(
    graph: CutCellGraph, nodes: NDArray[np.integer], chosen: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return distances through the body from vertices that are far apart to all, (k, l).

    The distance between two points is at least the greatest difference of such distances.

    Shapes: nodes (k,), those of the vertices; chosen (k,), which may be landmarks.
    """
    lengths = graph.csr()
    points = graph.nodes[nodes]
    away = np.linalg.norm(points - points[chosen].mean(axis=0), axis=1)
    columns: list[NDArray[np.float64]] = []
    while len(columns) < LANDMARKS:
        landmark = int(np.where(chosen, away, -1.0).argmax())
        path = dijkstra(lengths, indices=nodes[landmark], limit=UNCONNECTED)[nodes]
        columns.append(np.minimum(path, UNCONNECTED))
        away = columns[-1] if len(columns) == 1 else np.minimum(away, columns[-1])
    return np.stack(columns, axis=1)


def alternatives(
    surface: Surface,
    points: NDArray[np.float64],
    closest: Points,
    place: NDArray[np.float64],
    radius: float,
    farther: float,
) -> Points:
    """Return closest points with those in other parts of the body that are little farther away.

    Points farther away than a radius have no others, and points on the surface none that are not.

    A part consists of the vertices that are nearest to one landmark. Sorted by point and distance.

    Shapes: points (p, 3), place (k, l).
    """
    part = place.argmin(axis=1)[surface.faces[surface.sample_face, 0]]
    results = [closest]
    for number in np.unique(part):
        samples = np.flatnonzero(part == number)
        other = surface.nearest(points, samples, radius + farther)
        least = closest.distance[other.point]
        results.append(other.subset(other.distance <= np.where(least > TIE, least + farther, TIE)))
    every = Points(*map(np.concatenate, zip(*results, strict=True)))
    return every.subset(np.lexsort((every.distance, every.point)))


def resolve(
    candidates: Points,
    place: NDArray[np.float64],
    where: NDArray[np.float64],
    mesh: WeldedMesh,
    radius: float,
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Choose a candidate for each vertex of a mesh; also return where it is not the closest.

    Vertices whose candidates are near to each other through the body take the nearest one. From
    these the choice spreads over the mesh, edge by edge: each other vertex takes the candidate
    whose distances from landmarks are most like those of its neighbours' matches.

    Shapes: place (c, l), where (c, 3); returns (k,) and (k,).
    """
    count, point = len(mesh.points), candidates.point
    nearest = candidates.first()

    def elsewhere(one: NDArray[np.intp], other: NDArray[np.intp]) -> NDArray[np.bool_]:
        straight = np.linalg.norm(where[one] - where[other], axis=1)
        return _landmark_distance(place[one], place[other]) > DETOUR * straight + MIN_DETOUR

    ambiguous = np.zeros(count, np.bool_)
    ambiguous[point[elsewhere(np.arange(len(point)), nearest[point])]] = True
    choice = np.where(ambiguous | (candidates.distance[nearest] > radius), -1, nearest)
    joined = _neighbours(mesh)
    while True:
        decided = choice >= 0
        support = joined @ decided.astype(np.float64)
        front = ambiguous & ~decided & (support > 0)
        if not front.any():
            break
        around = joined[front] @ np.where(decided[:, None], place[choice], 0.0)
        number = np.cumsum(front) - 1
        tried = np.flatnonzero(front[point])
        around = around[number[point[tried]]] / support[point[tried], None]
        cost = _landmark_distance(place[tried], around) + candidates.distance[tried]
        best = tried[np.lexsort((cost, point[tried]))]
        choice[point[best[::-1]]] = best[::-1]  # the first one is written last
        alike = tried[~elsewhere(tried, choice[point[tried]])]
        choice[point[alike[::-1]]] = alike[::-1]  # the closest in this part of the body
    choice = np.where(choice < 0, nearest, choice)
    return choice, choice != nearest


def _landmark_distance(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return at least how far points are apart through the body, (c,)."""
    return np.asarray(np.abs(one - other).max(axis=1))


def _neighbours(mesh: WeldedMesh) -> csr_array:
    """Return which vertices are joined by an edge, (k, k)."""
    start, end = mesh.edges.edges.T
    entries = np.ones(2 * len(start)), (np.append(start, end), np.append(end, start))
    return coo_array(entries, (len(mesh.points),) * 2).tocsr()
