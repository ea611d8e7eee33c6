"""One joint's distance by several measures, each with its paths, to compare the graph with."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from cutcell.checks import check_choice
from cutcell.errors import ParameterError
from cutcell.geodesics import BoneDistances, BoneDistanceSolver, Bones, trace_path
from cutcell.geodesics.fallback import why_not_reached
from cutcell.geometry.edges import find_edges
from cutcell.geometry.segments import closest_on_segment, distance_to_segment
from cutcell.graph import CutCellGraph, build_graph
from cutcell.method import Method
from cutcell.rig import Rig
from cutcell.rig.rows import with_columns
from cutcell.runtime.progress import Progress

from .body import Body
from .volumes.voxel_binding import voxels_of_bone
from .volumes.voxels import PAD, Voxels, voxelize

Measure = Literal["straight", "surface", "voxel", "6", "26", "any", "converged"]
MEASURES: tuple[Measure, ...] = get_args(Measure)

SIDES = np.array([
    [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
    [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
    [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
])  # fmt: skip
"""Corners of the three sides of a voxel at its lowest corner, anticlockwise from outside."""


@dataclass(frozen=True, eq=False)
class MeasuredDistance:
    """Distance of every vertex from one joint's bones by one measure.

    Parameters
    ----------
    vertices : array, shape (n,), float64
        In longest sides of the mesh; infinite where no path leads.
    path_from : callable
        Takes a vertex, and returns the points of its shortest path to the bones in the file's
        units, shape (p, 3), empty where there is none.
    sides : array, shape (s, 4, 3), float64
        With voxels: their outer sides, in the file's units.
    side_distance : array, shape (s, 4), float64
        At the corners of the sides, the mean of the voxels about each.
    """

    vertices: NDArray[np.float64]
    path_from: Callable[[int], NDArray[np.float64]]
    sides: NDArray[np.float64]
    side_distance: NDArray[np.float64]


def measure_distance(
    rig: Rig, distances: BoneDistances, joint: int, measure: Measure, method: Method
) -> MeasuredDistance:
    """Measure the distance of the skin from a joint's bones.

    Raises
    ------
    ParameterError
        An unknown measure, or a joint without bones.
    """
    check_choice("measure", measure, MEASURES)
    if joint not in distances.bones.joint:
        raise ParameterError(f"joint {joint} has no bone: it may not carry weight")
    bones = distances.bones.subset(distances.bones.joint == joint)
    body = replace(Body.of(rig, resolution=method.resolution), bones=bones)
    if measure == "straight":
        return _straight(body)
    if measure == "surface":
        return _over_surface(body)
    if measure == "voxel":
        return _along_voxels(body)
    return _in_graph(rig, bones, joint, method.with_options(connectivity=_CONNECTIVITY[measure]))


_CONNECTIVITY = {"6": 6, "26": 26, "any": "any", "converged": "any"}


def mean_error(one: MeasuredDistance, converged: MeasuredDistance) -> float:
    """Return the mean difference of distances, relative to the mean distance.

    Only vertices that both reach count; NaN where there are none.
    """
    both = np.isfinite(one.vertices) & np.isfinite(converged.vertices)
    if not both.any():
        return float("nan")
    away = np.abs(one.vertices - converged.vertices)[both].mean()
    return float(away / converged.vertices[both].mean())


@dataclass(frozen=True)
class ErrorPoint:
    """The mean error of a connectivity at a resolution, and seconds for graph and distances."""

    measure: Measure
    resolution: int
    error: float
    seconds: float


def error_points(
    rig: Rig,
    distances: BoneDistances,
    joint: int,
    method: Method,
    resolutions: Sequence[int],
    progress: Progress,
) -> list[ErrorPoint]:
    """Measure the error of each connectivity at some resolutions.

    The resolution of `method` is that of the converged distances.
    """

    def measured(measure: Measure, resolution: int) -> MeasuredDistance:
        with_resolution = method.with_options(resolution=resolution)
        return measure_distance(rig, distances, joint, measure, with_resolution)

    converged = measured("converged", method.resolution)
    points: list[ErrorPoint] = []
    measures: tuple[Measure, ...] = ("6", "26", "any")
    pairs = list(product(measures, resolutions))
    for measure, resolution in pairs:
        progress("errors", len(points) / len(pairs))
        began = time.perf_counter()
        one = measured(measure, resolution)
        seconds = time.perf_counter() - began
        points.append(ErrorPoint(measure, resolution, mean_error(one, converged), seconds))
    return points


def _straight(body: Body) -> MeasuredDistance:
    start, end = body.bones.start, body.bones.end

    def path_from(vertex: int) -> NDArray[np.float64]:
        point = body.points[body.index[vertex]]
        nearest = distance_to_segment(point, start, end).argmin()
        foot, _ = closest_on_segment(point, start[nearest], end[nearest])
        return body.lattice.to_file(np.stack([point, foot]))

    return _measured(body.straight().min(axis=0)[body.index], path_from)


def _over_surface(body: Body) -> MeasuredDistance:
    """Measure along edges, from the vertices nearest to points on the bones, as in the graph."""
    points, start, end = body.points, body.bones.start, body.bones.end
    used = np.unique(body.faces)
    tree, near, away = cKDTree(points[used]), [], []
    for one, other in zip(start, end, strict=True):
        steps = int(np.ceil(body.lattice.resolution * np.linalg.norm(other - one))) + 1
        nearest = tree.query(one + np.linspace(0, 1, steps)[:, None] * (other - one))[1]
        near.append(used[np.unique(nearest)])
        away.append(distance_to_segment(points[near[-1]], one, other))
    edges = find_edges(body.faces).edges
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    reached, before = _search(
        len(points), edges, lengths, np.concatenate(near), np.concatenate(away)
    )

    def path_from(vertex: int) -> NDArray[np.float64]:
        return body.lattice.to_file(points[_walk(before, reached, body.index[vertex])])

    return _measured(reached[body.index], path_from)


def _along_voxels(body: Body) -> MeasuredDistance:
    voxels = voxelize(body)
    links, lengths = voxels.links()
    ends = zip(body.bones.start, body.bones.end, strict=True)
    near = np.unique(np.concatenate([voxels_of_bone(voxels, *pair) for pair in ends]))
    reached, before = _search(len(voxels.centres), links, lengths, near, np.zeros(len(near)))
    start = voxels.at(body.points)
    away = np.linalg.norm(body.points - voxels.centres[start], axis=1)

    def path_from(vertex: int) -> NDArray[np.float64]:
        welded = body.index[vertex]
        centres = voxels.centres[_walk(before, reached, start[welded])]
        whole = np.concatenate([body.points[[welded]], centres]) if len(centres) else centres
        return body.lattice.to_file(whole)

    sides, at_corners = _seen_sides(voxels, reached)
    sides = body.lattice.to_file(sides)
    return MeasuredDistance((reached[start] + away)[body.index], path_from, sides, at_corners)


def _in_graph(rig: Rig, bones: Bones, joint: int, method: Method) -> MeasuredDistance:
    graph = build_graph(rig.mesh, method=method)
    distances = distances_from(graph, bones, method.samples, len(rig.skeleton.joints))
    field = distances.field(joint)

    def path_from(vertex: int) -> NDArray[np.float64]:
        return graph.lattice.to_file(trace_path(distances, joint, vertex, field).points)

    return _measured(field[graph.vertex_node], path_from)


def _measured(
    vertices: NDArray[np.float64], path_from: Callable[[int], NDArray[np.float64]]
) -> MeasuredDistance:
    return MeasuredDistance(vertices, path_from, np.empty((0, 4, 3)), np.empty((0, 4)))


def _search(
    count: int,
    links: NDArray[np.int32],
    lengths: NDArray[np.float64],
    sources: NDArray[np.intp],
    starts: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return the distance of each node, and the node before it, negative at sources.

    An additional node is joined to all sources, at their initial distances.
    """
    least = 1e-12  # a sparse matrix has no link of length zero
    a = np.concatenate([links[:, 0], np.full(len(sources), count)])
    b = np.concatenate([links[:, 1], sources])
    along = np.maximum(np.concatenate([lengths, starts]), least)
    # Keep the shorter of two links between the same nodes: a matrix would add them.
    order = np.lexsort((along, b, a))
    pairs = np.stack([a, b])[:, order]
    first = order[np.diff(pairs, prepend=-1).any(axis=0)]
    matrix = coo_array((along[first], (a[first], b[first])), shape=(count + 1, count + 1))
    reached, before = dijkstra(
        matrix.tocsr(), directed=False, indices=count, return_predecessors=True
    )
    before[before == count] = -1
    return reached[:count], before[:count]


def _walk(before: NDArray[np.int32], reached: NDArray[np.float64], node: int) -> NDArray[np.intp]:
    """List the nodes from one back to a source; none where no path leads."""
    nodes = []
    while node >= 0 and np.isfinite(reached[node]):
        nodes.append(node)
        node = int(before[node])
    return np.array(nodes, np.intp)


def _seen_sides(
    voxels: Voxels, distance: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the corners of the sides between solid voxels and others, (s, 4, 3), and distances.

    A corner, of shape (s, 4), has the mean of the solid voxels that it is one of.
    """
    lows, numbers = np.argwhere(voxels.solid), []  # in the order of their numbers
    for axis in range(3):
        for step in (-1, 1):
            neighbour = np.roll(voxels.number, -step, axis=axis)
            low = lows[voxels.number[(voxels.number >= 0) & (neighbour < 0)]]
            low[:, axis] += step > 0
            numbers.append(low[:, None] + (SIDES[axis] if step < 0 else SIDES[axis][::-1]))
    corners = np.concatenate(numbers)
    total, count = np.zeros((2, *np.add(voxels.solid.shape, 1)))
    for corner in product((0, 1), repeat=3):
        at = tuple((lows + corner).T)
        total[at] += distance  # no two voxels share this corner
        count[at] += 1
    at = tuple(np.moveaxis(corners, 2, 0))
    return (corners - PAD) / voxels.resolution, total[at] / count[at]


def distances_from(graph: CutCellGraph, bones: Bones, samples: int, joints: int) -> BoneDistances:
    """Compute the distances of given bones to each vertex along a graph, without a fallback."""
    solver = BoneDistanceSolver(graph)
    sources = solver.sources(bones, samples)
    rows = with_columns(solver.paths(bones, sources), np.unique(bones.joint), joints)
    why = why_not_reached(solver, bones, sources, rows, solver.targets, None)
    return BoneDistances(rows, None, None, bones, sources, why[graph.vertex_node], solver)
