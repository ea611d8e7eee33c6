"""From a mesh to its cut-cell graph (paper section 3.1, algorithm 1)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..checks import check_choice, check_number
from ..progress import Progress, silent
from ..rig import TriangleMesh
from .backends import cast_rays_embree, cast_rays_open3d, find_runs_fast
from .caps import cap_holes
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .holes import find_needs
from .inside_edges import diagonal_edges, segment_edges
from .interior import interior_points
from .lattice import Lattice
from .memory import check_memory
from .rays import AXES, Crossings, cast_rays
from .segments import NONE, Runs, find_runs
from .weld import weld
from .winding import find_boundary

CASTERS = {"raster": cast_rays, "open3d": cast_rays_open3d, "embree": cast_rays_embree}


def build_graph(
    mesh: TriangleMesh,
    resolution: int = 64,
    *,
    winding_threshold: float = 0.5,
    connectivity: int | str = 6,
    rays: str = "raster",
    winding: str = "exact",
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
    connectivity : {6, 26, "any"}
        6 is the paper's graph, whose paths inside run along the axes. 26 adds the
        diagonals of lattice cells that lie inside altogether: straighter, shorter paths.
        "any" has the edges of 6, but lets paths leave them where they see far: distances
        then converge to the geodesic ones, see `geodesics.any_angle`.
    rays : {"raster", "open3d", "embree"}
        What casts the rays: our own kernel in double precision, or a ray tracer in single.
    winding : {"exact", "fast"}
        What decides which pieces are inside: exact winding numbers, or libigl's
        approximation at every midpoint. This and `rays` are for comparing.
    progress : callable
        See `cutcell.progress`; the stage is called "graph".

    Returns
    -------
    CutCellGraph

    Raises
    ------
    ParameterError
        A parameter is out of its range, or the graph would not fit in memory.
    MissingLibraryError
        `rays` or `winding` names a library that is not installed.

    References
    ----------
    Paper section 3.1 "Graph construction".
    """
    lattice = Lattice.around(mesh, resolution)
    resolution = lattice.resolution
    winding_threshold = check_number("winding_threshold", winding_threshold, 0, 1)
    check_choice("connectivity", connectivity, (6, 26, "any"))
    cast = CASTERS[check_choice("rays", rays, tuple(CASTERS))]
    check_choice("winding", winding, ("exact", "fast"))

    progress("graph", 0.0)
    vertices, vertex_node = weld(lattice.to_unit(mesh.vertices))
    faces = vertex_node[mesh.faces]
    boundary = find_boundary(faces)
    caps = cap_holes(vertices, boundary)
    needs = find_needs(caps, resolution, winding_threshold)
    crossings, runs = [], []
    for axis in range(3):
        progress("graph", 0.1 + 0.25 * axis)
        found = cast(vertices, faces, resolution, axis)
        crossings.append(found)
        if winding == "fast":
            inside = find_runs_fast(vertices, faces, found, resolution, axis, winding_threshold)
        else:
            inside = find_runs(
                vertices, found, boundary, caps, needs, resolution, axis, winding_threshold
            )
        runs.append(inside)
    progress("graph", 0.85)
    graph = _assemble(
        vertices, vertex_node, faces, len(caps.faces) == 0, crossings, runs, lattice, connectivity
    )
    progress("graph", 1.0)
    return graph


def _assemble(
    vertices: NDArray[np.float64],
    vertex_node: NDArray[np.int32],
    faces: NDArray[np.int32],
    is_closed: bool,
    crossings: list[Crossings],
    runs: list[Runs],
    lattice: Lattice,
    connectivity: int | str,
) -> CutCellGraph:
    """Give each node its number and list the edges."""
    points = interior_points(runs, lattice.resolution)
    crossed = sum(len(c.position) for c in crossings)
    check_memory(len(vertices), len(points), crossed, lattice.resolution, connectivity)
    first_point = len(vertices)
    first_crossing = first_point + len(points)

    crossing_node, positions, triangles = [], [], []
    count = first_crossing
    for axis in range(3):
        used = np.zeros(len(crossings[axis].position), np.bool_)
        for ends in (runs[axis].low, runs[axis].high):
            used[ends[ends != NONE]] = True
        crossing_node.append((np.cumsum(used) - 1 + count).astype(np.int32))
        positions.append(_crossing_positions(crossings[axis], used, axis, lattice.resolution))
        triangles.append(crossings[axis].triangle[used])
        count += len(triangles[-1])
    nodes = np.concatenate([vertices, points.positions(), *positions])
    of_triangle = np.concatenate(triangles)
    node_kind = _kinds([len(vertices), len(points), len(of_triangle)])
    triangle = np.concatenate([np.full(first_crossing, -1, np.int32), of_triangle])

    whole = np.zeros((3, len(points)), np.bool_)
    inside = [
        segment_edges(runs[axis], axis, points, first_point, crossing_node[axis], whole[axis])
        for axis in range(3)
    ]
    if connectivity == 26:
        inside.append(diagonal_edges(points, first_point, whole))
    to_corners = np.empty((len(of_triangle), 3, 2), np.int32)
    to_corners[:, :, 0] = np.arange(first_crossing, len(nodes))[:, None]
    to_corners[:, :, 1] = faces[of_triangle]
    parts = [_mesh_edges(faces), np.concatenate(inside), to_corners.reshape(-1, 2)]
    edges = np.concatenate(parts)
    return CutCellGraph(
        nodes=nodes,
        node_kind=node_kind,
        edges=edges,
        lengths=_lengths(nodes, edges),
        edge_kind=_kinds([len(part) for part in parts]),
        triangle=triangle,
        vertex_node=vertex_node,
        faces=faces,
        lattice=lattice,
        is_closed=is_closed,
        connectivity=connectivity,
        interior=points,
        whole=whole,
    )


def _kinds(counts: list[int]) -> NDArray[np.uint8]:
    return np.repeat(np.array([MESH, INTERIOR, SURFACE], np.uint8), counts)


def _crossing_positions(
    crossings: Crossings, used: NDArray[np.bool_], axis: int, resolution: int
) -> NDArray[np.float64]:
    """Return the used crossings' places in the unit cube, shape (c, 3)."""
    ray = np.repeat(np.arange(resolution**2), np.diff(crossings.start))[used]
    u, v, along = AXES[axis]
    positions = np.empty((len(ray), 3))
    positions[:, u] = (ray // resolution + 0.5) / resolution
    positions[:, v] = (ray % resolution + 0.5) / resolution
    positions[:, along] = crossings.position[used]
    return positions


@njit(cache=True)
def _lengths(nodes, edges):
    lengths = np.empty(len(edges))
    for e in range(len(edges)):
        a, b = edges[e, 0], edges[e, 1]
        x, y, z = nodes[a, 0] - nodes[b, 0], nodes[a, 1] - nodes[b, 1], nodes[a, 2] - nodes[b, 2]
        lengths[e] = np.sqrt(x * x + y * y + z * z)
    return lengths


def _mesh_edges(faces: NDArray[np.int32]) -> NDArray[np.int32]:
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    low, high = ends.min(axis=1), ends.max(axis=1)
    size = int(faces.max()) + 1
    keys = np.unique((low * size + high)[low != high])  # welding can close an edge up
    return np.stack([keys // size, keys % size], axis=1).astype(np.int32)
