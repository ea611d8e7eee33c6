"""From a mesh to its cut-cell graph (paper section 3.1, algorithm 1)."""

from __future__ import annotations

import numpy as np

from ..checks import check_choice, check_flag, check_number
from ..progress import Progress, share_of, silent
from ..rig import TriangleMesh
from .assemble import assemble
from .backends import cast_rays_embree, cast_rays_open3d, find_runs_fast
from .boundary import boundary_of
from .cutcell_graph import CutCellGraph
from .lattice import Lattice
from .memory import check_estimate
from .mesh_edges import find_edges
from .orientation import find_inverted, flipped
from .rays import cast_all_rays
from .segments import find_runs
from .weld import weld

CASTERS = {"open3d": cast_rays_open3d, "embree": cast_rays_embree}


def build_graph(
    mesh: TriangleMesh,
    resolution: int = 64,
    *,
    winding_threshold: float = 0.5,
    connectivity: int | str = 6,
    rays: str = "raster",
    winding: str = "exact",
    orient: bool = True,
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
    orient : bool
        Whether faces that are inside out count as turned round, see `inverted_faces`. The
        mesh itself stays as it is.
    progress : callable
        See `cutcell.progress`; the stage is called "graph".

    Returns
    -------
    CutCellGraph

    Raises
    ------
    MeshError
        The mesh is too large or too small to compute with.
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
    connectivity = check_choice("connectivity", connectivity, (6, 26, "any"))
    orient = check_flag("orient", orient)
    check_choice("rays", rays, ("raster", *CASTERS))
    check_choice("winding", winding, ("exact", "fast"))

    def tell(done: float) -> None:
        progress("graph", done)

    tell(0.0)
    vertices, vertex_node = weld(lattice.to_unit(mesh.vertices))
    faces = vertex_node[mesh.faces]
    mesh_edges, balance, partner = find_edges(faces)
    inverted = np.zeros(len(faces), np.bool_)
    if orient:
        inverted = find_inverted(vertices, faces, partner, share_of(tell, 0, 0.03))
    if inverted.any():
        faces = flipped(faces, inverted)
        mesh_edges, balance, _ = find_edges(faces)
    boundary = boundary_of(mesh_edges, balance)
    tell(0.03)
    check_estimate(
        vertices,
        faces,
        boundary,
        resolution,
        winding_threshold,
        connectivity,
        share_of(tell, 0.03, 0.05),
    )
    tell(0.05)
    if rays == "raster":
        crossings = cast_all_rays(vertices, faces, resolution, share_of(tell, 0.05, 0.2))
    else:
        crossings = [CASTERS[rays](vertices, faces, resolution, axis) for axis in range(3)]
    tell(0.2)
    if winding == "exact":
        runs = find_runs(
            vertices,
            faces,
            crossings,
            boundary,
            resolution,
            winding_threshold,
            share_of(tell, 0.2, 0.9),
        )
    else:
        runs = [
            find_runs_fast(vertices, faces, found, resolution, axis, winding_threshold)
            for axis, found in enumerate(crossings)
        ]
    tell(0.9)
    is_closed = len(boundary.loop) == 0
    found = vertices, vertex_node, faces, mesh_edges, is_closed, crossings, runs
    graph = assemble(*found, lattice, connectivity, inverted)
    tell(1.0)
    return graph
