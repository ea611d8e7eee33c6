"""From a mesh to its cut-cell graph (paper section 3.1, algorithm 1)."""

from __future__ import annotations

from functools import partial
from typing import Unpack

from ..checks import check_choice
from ..method import ANIMATION, GraphOptions, Method, MethodName, method_of
from ..rig.inputs import MeshLike, as_mesh
from ..runtime.progress import Progress, share_of, silent
from ..runtime.threads import cancellable
from .assemble import assemble
from .cutcell_graph import CutCellGraph
from .fingerprint import graph_fingerprint
from .libraries import CASTERS, fast_winding_numbers
from .memory import check_hits
from .rays import cast_all_rays, part_at_contacts
from .segments import PointwiseWindingNumbers, RayWindingNumbers, inside_intervals
from .surface import prepare_surface
from .winding.treecode.winding_numbers import TreecodeWindingNumbers


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
        "any" there are the edges of 6, which paths may leave, see `animation.any_angle`.

    Returns
    -------
    CutCellGraph

    Raises
    ------
    MeshError
        The mesh is too large or too small to compute with, or its faces are repeated hundreds of
        times.
    ParameterError
        A parameter is out of its range.
    TooLargeError
        The graph would not fit in memory.
    MissingLibraryError
        `rays` or `winding` names a library that is not installed.

    References
    ----------
    Paper section 3.1 "Graph construction", algorithm 1.
    """
    mesh = as_mesh(mesh)
    method = method_of(method, resolution, **options)
    check_choice("rays", rays, ("raster", *CASTERS))
    check_choice("winding", winding, ("exact", "fast"))
    resolution, tau = method.resolution, method.winding_threshold

    def build(report_stage: Progress) -> CutCellGraph:
        def report(done: float) -> None:
            report_stage("graph", done)

        report(0.0)
        fill = method.connectivity != 6  # the paper's graph leaves voids empty
        surface = prepare_surface(mesh, resolution, method.orient, fill, share_of(report, 0, 0.05))
        check_hits(surface)
        shape = surface.vertices, surface.faces, resolution
        if rays == "raster":
            hits = cast_all_rays(*shape, share_of(report, 0.05, 0.2))
        else:
            hits = [CASTERS[rays](*shape, axis) for axis in range(3)]
        hits = [part_at_contacts(along, surface.part) for along in hits]
        report(0.2)
        if winding == "exact":
            numbers: RayWindingNumbers = TreecodeWindingNumbers(
                surface, hits, tau, share_of(report, 0.2, 0.45)
            )
        else:
            fast = partial(fast_winding_numbers, surface.vertices, surface.faces)
            numbers = PointwiseWindingNumbers(surface, fast)
        # Hits and lattice points divide the rays into segments. Those whose midpoint has a winding
        # number of at least tau are kept.
        inside = inside_intervals(hits, tau, numbers, resolution, share_of(report, 0.45, 0.9))
        graph = assemble(surface, hits, inside, method.connectivity, tau)
        object.__setattr__(graph, "fingerprint", graph_fingerprint(mesh, method, rays, winding))
        report(1.0)
        return graph

    return cancellable(build, progress, "graph")
