"""Number the nodes of a graph and list its edges, straight into the arrays to be kept."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled, put
from ..threads import in_threads
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .inside_edges import diagonal_edges, edge_starts, fill_edges
from .interior import OUTSIDE, interior_points
from .lattice import Lattice
from .memory import check_memory
from .rays import AXES, Crossings
from .segments import NONE, Runs


def assemble(
    vertices: NDArray[np.float64],
    vertex_node: NDArray[np.int32],
    faces: NDArray[np.int32],
    mesh_edges: NDArray[np.int32],
    is_closed: bool,
    crossings: Sequence[Crossings],
    runs: Sequence[Runs],
    lattice: Lattice,
    connectivity: int | str,
    inverted: NDArray[np.bool_],
) -> CutCellGraph:
    """Build the graph from what the rays found.

    Parameters
    ----------
    vertices : array, shape (n, 3), float64
        Of the welded mesh, in the unit cube.
    vertex_node : array, int32
        Which of them each vertex of the mesh became.
    faces, mesh_edges : arrays, shapes (m, 3) and (e, 2), int32
        Of the welded mesh.
    is_closed : bool
    crossings, runs : of the rays along x, y and z
    lattice : Lattice
    connectivity : {6, 26, "any"}
    inverted : array, shape (m,), bool
        Which of the faces were turned round.

    Raises
    ------
    ParameterError
        The graph would not fit in memory.
    """
    resolution = lattice.resolution
    points = interior_points(runs, resolution)
    first_crossing = len(vertices) + len(points)
    numbers, starts = [], []
    node, edge = first_crossing, len(mesh_edges)
    for run, found in zip(runs, crossings, strict=True):
        numbers.append(_number_used(run.low, run.high, len(found.position), node))
        starts.append(edge_starts(run, edge))
        node, edge = max(node, int(numbers[-1].max(initial=0)) + 1), int(starts[-1][-1])
    node_kinds = [len(vertices), len(points), node - first_crossing]
    edge_kinds = [len(mesh_edges), edge - len(mesh_edges), 3 * node_kinds[SURFACE]]
    check_memory(len(vertices), len(points), node_kinds[SURFACE], resolution, connectivity)

    nodes, triangle = np.empty((node, 3)), np.full(node, -1, np.int32)
    edges, lengths = np.empty((sum(edge_kinds), 2), np.int32), np.empty(sum(edge_kinds))
    steps = np.full((len(points) if connectivity != 6 else 0, 6), OUTSIDE, np.int32)

    def fill_inside(axis: int) -> None:
        ends = crossings[axis].position, numbers[axis]
        fill_edges(
            runs[axis], starts[axis], axis, points, len(vertices), ends, edges, lengths, steps
        )

    def fill_surface(axis: int) -> None:
        found = crossings[axis]
        hits = found.start, found.position, found.triangle, numbers[axis]
        mesh = vertices, faces
        first = first_crossing, edge
        _fill_crossings(resolution, AXES[axis], hits, mesh, first, nodes, triangle, edges, lengths)

    def fill_rest(_: int) -> None:
        _fill_mesh(vertices, mesh_edges, nodes, edges, lengths)
        points.put_positions(nodes[len(vertices) : first_crossing])

    jobs = [(job, axis) for job in (fill_inside, fill_surface) for axis in range(3)]
    in_threads(lambda job: job[0](job[1]), [*jobs, (fill_rest, 0)])
    if connectivity == 26:
        diagonals = diagonal_edges(steps, len(vertices))
        edges = np.concatenate([edges[:edge], diagonals, edges[edge:]])
        ends = nodes[diagonals]
        apart = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
        lengths = np.concatenate([lengths[:edge], apart, lengths[edge:]])
        edge_kinds[INTERIOR] += len(diagonals)
    return CutCellGraph(
        nodes=nodes,
        node_kind=_kinds(node_kinds),
        edges=edges,
        lengths=lengths,
        edge_kind=_kinds(edge_kinds),
        triangle=triangle,
        vertex_node=vertex_node,
        faces=faces,
        lattice=lattice,
        is_closed=is_closed,
        connectivity=connectivity,
        interior=points,
        steps=steps,
        inverted=inverted,
    )


def _kinds(counts: list[int]) -> NDArray[np.uint8]:
    return np.repeat(np.array([MESH, INTERIOR, SURFACE], np.uint8), counts)


@compiled
def _number_used(low, high, crossings, first):
    """Give the crossings at the ends of runs numbers from `first` on, and the others NONE."""
    node = np.full(crossings, NONE, np.int32)
    for r in range(len(low)):
        if low[r] != NONE:
            node[low[r]] = 0
        if high[r] != NONE:
            node[high[r]] = 0
    for c in range(crossings):
        if node[c] != NONE:
            node[c] = first
            first += 1
    return node


@compiled
def _fill_mesh(vertices, mesh_edges, nodes, edges, lengths):
    put(vertices.reshape(-1), nodes.reshape(-1))
    for e in range(len(mesh_edges)):
        a, b = mesh_edges[e, 0], mesh_edges[e, 1]
        edges[e, 0], edges[e, 1] = a, b
        lengths[e] = _apart(vertices, a, vertices, b)


@compiled
def _fill_crossings(resolution, axes, hits, mesh, first, nodes, triangle, edges, lengths):
    """Place the crossings along one axis that have nodes, and tie them to their corners."""
    u, v, along = axes
    start, position, of_triangle, node = hits
    vertices, faces = mesh
    first_crossing, first_edge = first
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
                e = first_edge + 3 * (n - first_crossing) + k
                corner = faces[of_triangle[c], k]
                edges[e, 0], edges[e, 1] = n, corner
                lengths[e] = _apart(nodes, n, vertices, corner)


@compiled(inline="always")
def _apart(a, i, b, j):
    x, y, z = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    return np.sqrt(x * x + y * y + z * z)
