"""The stages of `build_graph` one by one, so that each can be timed beside its peers."""

from __future__ import annotations

import numpy as np

from cutcell import TriangleMesh
from cutcell.graph.rays import RayHits, cast_all_rays
from cutcell.graph.segments import InsideIntervals, divide_rays
from cutcell.graph.surface import Surface, prepare_surface
from cutcell.graph.winding.treecode.intervals import treecode_intervals


def prepare(mesh: TriangleMesh, resolution: int) -> Surface:
    """Scale and weld a mesh as `build_graph` does; its faces stay as they are."""
    return prepare_surface(mesh, resolution, orient=False)


def cast(prepared: Surface) -> list[RayHits]:
    """Cast the rays of all three axes."""
    return cast_all_rays(prepared.vertices, prepared.faces, prepared.resolution)


def decide(prepared: Surface, hits: list[RayHits], threshold: float = 0.5) -> list[InsideIntervals]:
    """Decide which segments are inside, along all three axes."""
    return treecode_intervals(prepared, hits, threshold)


def midpoints(prepared: Surface, hits: list[RayHits]) -> np.ndarray:
    """List the midpoints between the first and last hit of each ray, shape (q, 3)."""
    points = []
    for axis, along in enumerate(hits):
        rays = np.flatnonzero(np.diff(along.start))
        segments = divide_rays(along, rays, prepared.resolution)
        begins, ends = along.start[segments.ray], along.start[segments.ray + 1]
        between = (segments.gap > begins) & (segments.gap < ends)
        middle = (segments.low + segments.high) / 2
        points.append(segments.points(middle, prepared.resolution, axis)[between])
    return np.concatenate(points)
