"""The stages of `build_graph` one by one, so that each can be timed beside its peers."""

from __future__ import annotations

import numpy as np

from cutcell import TriangleMesh
from cutcell.graph.rays import RayHits, cast_all_rays
from cutcell.graph.segments import NONE, InsideIntervals, divide_rays, inside_intervals
from cutcell.graph.surface import Surface, prepare_surface
from cutcell.graph.winding.treecode.winding_numbers import TreecodeWindingNumbers


def prepare(mesh: TriangleMesh, resolution: int) -> Surface:
    """Scale and weld a mesh as `build_graph` does; its faces stay as they are."""
    return prepare_surface(mesh, resolution, orient=False)


def cast(prepared: Surface) -> list[RayHits]:
    """Cast the rays of all three axes."""
    return cast_all_rays(prepared.mesh.points, prepared.mesh.faces, prepared.resolution)


def decide(prepared: Surface, hits: list[RayHits], threshold: float = 0.5) -> list[InsideIntervals]:
    """Decide which segments are inside, along all three axes."""
    numbers = TreecodeWindingNumbers(prepared, hits, threshold)
    return inside_intervals(hits, threshold, numbers, prepared.resolution)


def midpoints(prepared: Surface, hits: list[RayHits]) -> np.ndarray:
    """List the midpoints between the first and last hit of each ray, shape (q, 3)."""
    resolution = prepared.resolution
    nothing = np.tile(np.array([resolution, NONE], np.int32), (resolution**2, 1))
    rays = np.arange(resolution**2)
    return np.concatenate(
        [
            divide_rays(along, axis, resolution, rays, nothing).midpoints()
            for axis, along in enumerate(hits)
        ]
    )
