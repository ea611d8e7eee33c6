"""Number the nodes of a graph and list its edges, directly in their final arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..geometry.vectors import between, length
from ..runtime.compiled import no_refcount
from ..runtime.threads import in_threads
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .inside_edges import diagonal_edges, fill_edges, lattice_steps
from .interior import interior_points
from .memory import check_nodes
from .rays import AXES, RayHits
from .segments import NONE, InsideIntervals
from .surface import Surface


def assemble(
    surface: Surface,
    hits: Sequence[RayHits],
    inside: Sequence[InsideIntervals],
    connectivity: int | str,
    tau: float,
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
        along = hits[axis].start, hits[axis].position, hits[axis].triangle, numbers[axis]
        mesh = vertices, surface.faces
        first = first_surface, edge
        _fill_surface(resolution, AXES[axis], along, mesh, first, nodes, triangle, edges, lengths)

    def fill_rest(_: int) -> None:
        first_inside = len(mesh_edges)
        nodes[: len(vertices)], edges[:first_inside] = vertices, mesh_edges
        lengths[:first_inside] = np.linalg.norm(np.subtract(*vertices[mesh_edges.T]), axis=1)
        points.put_positions(nodes[len(vertices) : first_surface])

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
        winding_threshold=tau,
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


@no_refcount
def _fill_surface(resolution, axes, hits, mesh, first, nodes, triangle, edges, lengths):
    """Fill in the surface nodes along one axis, and their edges to the corners of triangles."""
    u, v, along = axes
    start, position, of_triangle, node = hits
    vertices, faces = mesh
    first_surface, first_edge = first
    for ray in range(resolution * resolution):
        for c in range(start[ray], start[ray + 1]):
            n = node[c]
            if n == NONE:
                continue
            nodes[n, u] = (ray // resolution + 0.5) / resolution
            nodes[n, v] = (ray % resolution + 0.5) / resolution
            nodes[n, along] = position[c]
            triangle[n] = of_triangle[c]
            for k in range(3):
                e = first_edge + 3 * (n - first_surface) + k
                corner = faces[of_triangle[c], k]
                edges[e, 0], edges[e, 1] = n, corner
                lengths[e] = length(between(nodes[n], vertices[corner]))
