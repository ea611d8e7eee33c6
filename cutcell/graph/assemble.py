"""Number the nodes of a graph and list its edges, directly in their final arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..runtime.threads import in_threads
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .inside_edges import diagonal_edges, fill_edges, lattice_steps
from .interior import interior_points
from .memory import check_nodes
from .rays import RayHits, points_on_rays
from .segments import NONE, InsideIntervals
from .surface import Surface


def assemble(
    surface: Surface,
    hits: Sequence[RayHits],
    inside: Sequence[InsideIntervals],
    connectivity: int | str,
    winding_threshold: float,
) -> CutCellGraph:
    """Build the graph of a surface from the hits of the rays and their intervals inside."""
    resolution, vertices, mesh_edges = surface.resolution, surface.vertices, surface.edges
    points = interior_points(inside, resolution)
    first_surface = len(vertices) + len(points)
    numbers, starts = [], []
    node, edge = first_surface, len(mesh_edges)
    for intervals, hits_along in zip(inside, hits, strict=True):
        ends = intervals.low, intervals.high
        numbers.append(_number_ends(*ends, len(hits_along.position), node))
        points_and_hits = (
            intervals.last - intervals.first + 1 + np.not_equal(ends, NONE).sum(axis=0)
        )
        starts.append(np.cumsum(np.append(edge, points_and_hits - 1)))
        node, edge = max(node, int(numbers[-1].max(initial=0)) + 1), int(starts[-1][-1])
    node_kinds = [len(vertices), len(points), node - first_surface]
    edge_kinds = [len(mesh_edges), edge - len(mesh_edges), 3 * node_kinds[SURFACE]]
    check_nodes(len(vertices), len(points), node_kinds[SURFACE], resolution, connectivity)

    nodes, triangle = np.empty((node, 3)), np.full(node, -1, np.int32)
    edges, lengths = np.empty((sum(edge_kinds), 2), np.int32), np.empty(sum(edge_kinds))

    def fill_inside(axis: int) -> None:
        where, intervals = (resolution, axis, len(vertices)), (*vars(inside[axis]).values(),)
        ends = hits[axis].position, numbers[axis]
        fill_edges(where, (*intervals, starts[axis]), points.table, ends, edges, lengths)

    def fill_surface(axis: int) -> None:
        hit = np.flatnonzero(numbers[axis] != NONE)  # their nodes follow one another
        if len(hit) == 0:
            return
        part = slice(numbers[axis][hit[0]], numbers[axis][hit[-1]] + 1)
        ray = np.searchsorted(hits[axis].start, hit, side="right") - 1
        triangle[part] = hits[axis].triangle[hit]
        nodes[part] = points_on_rays(ray, hits[axis].position[hit], resolution, axis)
        corners = surface.faces[triangle[part]]
        first = edge + 3 * (part.start - first_surface)
        links = slice(first, first + corners.size)
        edges[links, 0] = np.repeat(np.arange(part.start, part.stop), 3)
        edges[links, 1] = corners.ravel()
        way = vertices[corners] - nodes[part, None]
        lengths[links] = np.linalg.norm(way, axis=2).ravel()

    def fill_rest(_: int) -> None:
        first_inside = len(mesh_edges)
        nodes[: len(vertices)], edges[:first_inside] = vertices, mesh_edges
        lengths[:first_inside] = np.linalg.norm(np.subtract(*vertices[mesh_edges.T]), axis=1)
        nodes[len(vertices) : first_surface] = points.positions()

    jobs = [(job, axis) for job in (fill_inside, fill_surface) for axis in range(3)]
    in_threads(lambda job: job[0](job[1]), [*jobs, (fill_rest, 0)])
    if connectivity == 26:
        steps = lattice_steps(nodes, edges[len(mesh_edges) : edge], len(vertices), first_surface)
        diagonals = len(vertices) + diagonal_edges(steps)
        edges = np.concatenate([edges[:edge], diagonals, edges[edge:]])
        distance = np.linalg.norm(np.diff(nodes[diagonals], axis=1)[:, 0], axis=1)
        lengths = np.concatenate([lengths[:edge], distance, lengths[edge:]])
        edge_kinds[INTERIOR] += len(diagonals)
    return CutCellGraph(
        nodes=nodes,
        node_kind=_kinds(node_kinds),
        edges=edges,
        lengths=lengths,
        edge_kind=_kinds(edge_kinds),
        triangle=triangle,
        vertex_node=surface.vertex_node,
        faces=surface.faces,
        lattice=surface.lattice,
        is_closed=surface.is_closed,
        connectivity=connectivity,
        interior=points,
        inverted=surface.inverted,
        omitted=surface.omitted,
        winding_threshold=winding_threshold,
    )


def _kinds(counts: list[int]) -> NDArray[np.uint8]:
    return np.repeat(np.array([MESH, INTERIOR, SURFACE], np.uint8), counts)


def _number_ends(
    low: NDArray[np.int32], high: NDArray[np.int32], hits: int, first: int
) -> NDArray[np.int32]:
    """Give numbers to the hits at the ends of intervals from `first` on; the others get NONE."""
    is_end = np.zeros(hits + 1, np.bool_)  # the last entry is for NONE
    is_end[low] = is_end[high] = True
    ends = np.flatnonzero(is_end[:-1])
    node = np.full(hits, NONE, np.int32)
    node[ends] = np.arange(first, first + len(ends))
    return node
