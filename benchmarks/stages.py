"""The stages of `build_graph` one by one, so that each can be timed beside its peers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cutcell import TriangleMesh
from cutcell.graph import Lattice
from cutcell.graph.boundary import find_boundary
from cutcell.graph.midpoints import list_segments
from cutcell.graph.rays import Crossings, cast_all_rays
from cutcell.graph.segments import Runs, find_runs
from cutcell.graph.weld import weld


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


def cast(prepared: Prepared) -> list[Crossings]:
    """Cast the rays of all three axes."""
    return cast_all_rays(prepared.vertices, prepared.faces, prepared.resolution)


def decide(prepared: Prepared, crossings: list[Crossings], threshold: float = 0.5) -> list[Runs]:
    """Decide which segments are inside, along all three axes."""
    boundary = find_boundary(prepared.faces)
    return find_runs(
        prepared.vertices, prepared.faces, crossings, boundary, prepared.resolution, threshold
    )


def midpoints(prepared: Prepared, crossings: list[Crossings]) -> np.ndarray:
    """List the midpoints between the first and last crossing of each ray, shape (q, 3)."""
    points = []
    for axis, found in enumerate(crossings):
        pieces = list_segments(found, prepared.resolution, closed=True)
        begins, ends = found.start[pieces.ray], found.start[pieces.ray + 1]
        between = (pieces.gap > begins) & (pieces.gap < ends)
        points.append(pieces.points(prepared.resolution, axis)[between])
    return np.concatenate(points)
