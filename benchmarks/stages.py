"""The stages of `build_graph` one by one, so that each can be timed beside its peers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cutcell import TriangleMesh
from cutcell.geometry.weld import weld
from cutcell.graph import Lattice
from cutcell.graph.fast_winding import list_segments
from cutcell.graph.rays import RayHits, cast_all_rays
from cutcell.graph.winding.boundary import find_boundary
from cutcell.graph.winding.intervals import InsideIntervals, inside_intervals


@dataclass(frozen=True)
class Prepared:
    """A mesh in the unit cube, welded."""

    vertices: np.ndarray
    faces: np.ndarray
    resolution: int


def prepare(mesh: TriangleMesh, resolution: int) -> Prepared:
    """Scale and weld a mesh as `build_graph` does."""
    lattice = Lattice.around(mesh, resolution)
    vertices, index = weld(lattice.to_unit(mesh.vertices))
    return Prepared(vertices, index[mesh.faces], lattice.resolution)


def cast(prepared: Prepared) -> list[RayHits]:
    """Cast the rays of all three axes."""
    return cast_all_rays(prepared.vertices, prepared.faces, prepared.resolution)


def decide(
    prepared: Prepared, crossings: list[RayHits], threshold: float = 0.5
) -> list[InsideIntervals]:
    """Decide which segments are inside, along all three axes."""
    boundary = find_boundary(prepared.faces)
    return inside_intervals(
        prepared.vertices, prepared.faces, crossings, boundary, prepared.resolution, threshold
    )


def midpoints(prepared: Prepared, crossings: list[RayHits]) -> np.ndarray:
    """List the midpoints between the first and last crossing of each ray, shape (q, 3)."""
    points = []
    for axis, midpoints_of in enumerate(crossings):
        pieces = list_segments(midpoints_of, prepared.resolution, closed=True)
        begins, ends = midpoints_of.start[pieces.ray], midpoints_of.start[pieces.ray + 1]
        between = (pieces.gap > begins) & (pieces.gap < ends)
        points.append(pieces.points(prepared.resolution, axis)[between])
    return np.concatenate(points)
