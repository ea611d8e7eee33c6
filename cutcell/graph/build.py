"""From a mesh to its cut-cell graph (paper section 3.1, algorithm 1)."""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from ..errors import MeshError
from ..geometry.edges import find_edges
from ..geometry.weld import weld
from ..method import ANIMATION, GraphOptions, Method, MethodName, method_of
from ..rig.checks import check_choice
from ..rig.inputs import MeshLike, as_mesh
from ..runtime.progress import Progress, share_of, silent
from ..runtime.threads import cancellable
from .assemble import assemble
from .cutcell_graph import CutCellGraph
from .fast_winding import fast_intervals
from .lattice import Lattice
from .memory import check_estimate
from .orientation.orient import find_inverted, flipped
from .ray_tracers import cast_rays_embree, cast_rays_open3d
from .rays import cast_all_rays, expected_hits
from .winding import inside_intervals
from .winding.boundary import boundary_of

CASTERS = {"open3d": cast_rays_open3d, "embree": cast_rays_embree}
MAX_LAYERS = 100
"""Faces that a ray through the mesh's cube may cross on average. Characters have 2 at most."""


def build_graph(
    mesh: MeshLike,
    resolution: int | None = None,
    *,
    method: Method | MethodName = ANIMATION,
    rays: str = "raster",
    winding: str = "exact",
    progress: Progress = silent,
    **options: Unpack[GraphOptions],
) -> CutCellGraph:
    """Build the cut-cell graph of a mesh.

    Parameters
    ----------
    mesh : TriangleMesh, (vertices, faces), trimesh.Trimesh or pyvista.PolyData
        Closed or open, any number of components; vertices at one place are welded.
    resolution : int, optional
        R, rays along each side of the unit cube, 2 to 1024; the method's when left out.
    method : Method, "animation" or "paper"
        Its resolution, connectivity, winding threshold and orientation count here.
    rays : {"raster", "open3d", "embree"}
        The ray caster: our own kernel in double precision, or a ray tracer in single.
    winding : {"exact", "fast"}
        Exact winding numbers, or libigl's approximation at every midpoint. This and `rays`
        are for comparison.
    progress : callable
        See `cutcell.runtime.progress`; the stage is called "graph".
    **options
        Single options of the method: `connectivity`, `winding_threshold`, `orient`. With
        connectivity 26 there are diagonals of lattice cells that lie inside altogether; with
        "any" there are the edges of 6, which paths may leave, see `geodesics.any_angle`.

    Returns
    -------
    CutCellGraph

    Raises
    ------
    MeshError
        The mesh is too large or too small to compute with, or its faces are repeated hundreds of
        times.
    ParameterError
        A parameter is out of its range, or the graph would not fit in memory.
    MissingLibraryError
        `rays` or `winding` names a library that is not installed.

    References
    ----------
    Paper section 3.1 "Graph construction", algorithm 1.
    """
    mesh = as_mesh(mesh)
    method = method_of(method, resolution, **options)
    lattice = Lattice.around(mesh, method.resolution)
    check_choice("rays", rays, ("raster", *CASTERS))
    check_choice("winding", winding, ("exact", "fast"))
    resolution, connectivity = method.resolution, method.connectivity
    winding_threshold = method.winding_threshold

    def build(report: Progress) -> CutCellGraph:
        def tell(done: float) -> None:
            report("graph", done)

        tell(0.0)
        vertices = lattice.to_unit(mesh.vertices)
        _check_layers(vertices, mesh.faces)
        vertices, vertex_node = weld(vertices)
        faces = vertex_node[mesh.faces]
        mesh_edges, incidence, partner = find_edges(faces)
        inverted = np.zeros(len(faces), np.bool_)
        if method.orient:
            inverted = find_inverted(vertices, faces, partner, share_of(tell, 0, 0.03))
        if inverted.any():
            faces = flipped(faces, inverted)
            mesh_edges, incidence, _ = find_edges(faces)
        boundary = boundary_of(mesh_edges, incidence)
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
            hits = cast_all_rays(vertices, faces, resolution, share_of(tell, 0.05, 0.2))
        else:
            hits = [CASTERS[rays](vertices, faces, resolution, axis) for axis in range(3)]
        tell(0.2)
        # Algorithm 1: segments of the rays whose midpoint has a winding number of at least tau.
        if winding == "exact":
            inside = inside_intervals(
                vertices,
                faces,
                hits,
                boundary,
                resolution,
                winding_threshold,
                share_of(tell, 0.2, 0.9),
            )
        else:
            inside = [
                fast_intervals(vertices, faces, found, resolution, axis, winding_threshold)
                for axis, found in enumerate(hits)
            ]
        tell(0.9)
        is_closed = len(boundary.loop) == 0
        found = vertices, vertex_node, faces, mesh_edges, is_closed, hits, inside
        graph = assemble(*found, lattice, connectivity, inverted, winding_threshold)
        tell(1.0)
        return graph

    return cancellable(build, progress, "graph")


def _check_layers(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> None:
    """Refuse faces in so many layers that a small file would take minutes."""
    layers = expected_hits(vertices, faces, 1) / 3
    if layers > MAX_LAYERS:
        raise MeshError(
            f"its {len(faces):,} faces lie in {layers:,.0f} layers on average, which would take "
            f"minutes. The limit is {MAX_LAYERS}. Remove repeated faces"
        )
