"""From a mesh to its cut-cell graph (paper section 3.1, algorithm 1)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..checks import check_choice, check_number
from ..progress import Progress, silent
from ..rig import TriangleMesh
from .caps import cap_holes
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .diagonals import cell_diagonals
from .lattice import Lattice
from .rays import AXES, Crossings, cast_rays
from .segments import NONE, Runs, find_runs
from .weld import weld
from .winding import find_boundary


def build_graph(
    mesh: TriangleMesh,
    resolution: int = 64,
    *,
    winding_threshold: float = 0.5,
    connectivity: int = 6,
    progress: Progress = silent,
) -> CutCellGraph:
    """Cut a lattice with a mesh and connect what lies inside.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed or open, any number of components; vertices at one place are welded.
    resolution : int
        R, rays along each side of the unit cube, 2 to 1024.
    winding_threshold : float
        tau: pieces of rays with at least this winding number count as inside, 0 to 1.
    connectivity : {6, 26}
        6 is the paper's graph, whose paths inside run along the axes. 26 adds the
        diagonals of lattice cells that lie inside altogether: straighter, shorter paths.
    progress : callable
        See `cutcell.progress`; the stage is called "graph".

    Returns
    -------
    CutCellGraph

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Paper section 3.1 "Graph construction".
    """
    lattice = Lattice.around(mesh, resolution)
    resolution = lattice.resolution
    winding_threshold = check_number("winding_threshold", winding_threshold, 0, 1)
    check_choice("connectivity", connectivity, (6, 26))

    progress("graph", 0.0)
    vertices, vertex_node = weld(lattice.to_unit(mesh.vertices))
    faces = vertex_node[mesh.faces]
    boundary = find_boundary(faces)
    caps = cap_holes(vertices, boundary)
    crossings, runs = [], []
    for axis in range(3):
        progress("graph", 0.1 + 0.25 * axis)
        found = cast_rays(vertices, faces, resolution, axis)
        crossings.append(found)
        runs.append(find_runs(vertices, found, boundary, caps, resolution, axis, winding_threshold))
    progress("graph", 0.85)
    graph = _assemble(
        vertices, vertex_node, faces, boundary, crossings, runs, lattice, connectivity
    )
    progress("graph", 1.0)
    return graph


def _assemble(
    vertices, vertex_node, faces, boundary, crossings, runs, lattice, connectivity
) -> CutCellGraph:
    """Give each node its number and list the edges."""
    resolution = lattice.resolution
    # Until they are numbered, nodes are known by keys: a lattice point by its number in
    # the lattice, a crossing by its place behind all of these.
    first_key = resolution**3 + np.cumsum([0, *(len(c.position) for c in crossings)])
    segments = [_segment_keys(runs[axis], axis, resolution, first_key[axis]) for axis in range(3)]
    keys = np.unique(np.concatenate(segments))
    lattice_count = np.searchsorted(keys, resolution**3)
    inner, outer = keys[:lattice_count], keys[lattice_count:]

    surface_points, triangle = _surface_nodes(outer, first_key, crossings, resolution)
    nodes = np.concatenate([vertices, _lattice_points(inner, resolution), surface_points])
    kinds = np.repeat(
        np.array([MESH, INTERIOR, SURFACE], np.uint8),
        [len(vertices), len(inner), len(outer)],
    )
    if connectivity == 26:
        segments.append(cell_diagonals(_whole_edges(segments, resolution), resolution))
    inside = np.searchsorted(keys, np.concatenate(segments)) + len(vertices)
    corners = faces[triangle]
    crossing = np.arange(len(nodes) - len(outer), len(nodes))
    to_corners = np.stack([np.repeat(crossing, 3), corners.ravel()], axis=1)
    parts = [_mesh_edges(faces), inside, to_corners]
    edges = np.concatenate(parts).astype(np.int32)
    edge_kind = np.repeat(
        np.array([MESH, INTERIOR, SURFACE], np.uint8), [len(part) for part in parts]
    )
    lengths = np.linalg.norm(nodes[edges[:, 0]] - nodes[edges[:, 1]], axis=1)
    of_node = np.full(len(nodes), -1, np.int32)
    of_node[len(nodes) - len(outer) :] = triangle
    closed = len(boundary.edges) == 0
    return CutCellGraph(
        nodes, kinds, edges, lengths, edge_kind, of_node, vertex_node, lattice, closed
    )


def _segment_keys(runs: Runs, axis: int, resolution: int, first_key: int) -> NDArray[np.int64]:
    """List the kept segments along one axis as pairs of keys, shape (s, 2)."""
    points = np.maximum(runs.last.astype(np.int64) - runs.first + 1, 0)
    ends = (runs.low != NONE).astype(np.int64) + (runs.high != NONE)
    start = np.concatenate([[0], np.cumsum(points + ends - 1)])
    strides = [resolution**2, resolution, 1]
    u, v, along = (strides[k] for k in AXES[axis])
    base = (runs.ray // resolution).astype(np.int64) * u + (runs.ray % resolution) * v
    segments = np.empty((start[-1], 2), np.int64)
    _expand(runs.first, runs.last, runs.low, runs.high, start, base, along, first_key, segments)
    return segments


@njit(cache=True)
def _expand(first, last, low, high, start, base, along, first_key, segments):
    for r in range(len(first)):
        n = start[r]
        previous = first_key + low[r] if low[r] != NONE else NONE
        for k in range(first[r], last[r] + 1):
            key = base[r] + k * along
            if previous != NONE:
                segments[n, 0], segments[n, 1] = previous, key
                n += 1
            previous = key
        if high[r] != NONE:
            segments[n, 0], segments[n, 1] = previous, first_key + high[r]


def _whole_edges(segments, resolution):
    """Return for each axis the sorted lattice numbers whose edge to the next is kept."""
    return tuple(
        np.sort(pairs[(pairs < resolution**3).all(axis=1)].min(axis=1)) for pairs in segments[:3]
    )


def _lattice_points(number: NDArray[np.int64], resolution: int) -> NDArray[np.float64]:
    index = np.stack(
        [number // resolution**2, number // resolution % resolution, number % resolution]
    )
    return (index.T + 0.5) / resolution


def _surface_nodes(
    keys: NDArray[np.int64],
    first_key: NDArray[np.int64],
    crossings: list[Crossings],
    resolution: int,
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return the positions (s, 3) and triangles (s,) of crossings given by sorted keys."""
    points = np.empty((len(keys), 3))
    triangle = np.empty(len(keys), np.int32)
    bounds = np.searchsorted(keys, first_key)
    for axis, found in enumerate(crossings):
        part = slice(bounds[axis], bounds[axis + 1])
        index = keys[part] - first_key[axis]
        ray = np.searchsorted(found.start, index, side="right") - 1
        u, v, along = AXES[axis]
        points[part, u] = (ray // resolution + 0.5) / resolution
        points[part, v] = (ray % resolution + 0.5) / resolution
        points[part, along] = found.position[index]
        triangle[part] = found.triangle[index]
    return points, triangle


def _mesh_edges(faces: NDArray[np.int32]) -> NDArray[np.int64]:
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    ends.sort(axis=1)
    ends = ends[ends[:, 0] != ends[:, 1]]  # welding can close an edge up
    size = int(faces.max()) + 1
    keys = np.unique(ends[:, 0] * size + ends[:, 1])
    return np.stack([keys // size, keys % size], axis=1)
