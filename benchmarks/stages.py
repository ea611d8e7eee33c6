"""The stages of `build_graph` one by one, so that each can be timed beside its peers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cutcell import TriangleMesh
from cutcell.graph import Lattice
from cutcell.graph.caps import cap_holes
from cutcell.graph.holes import find_needs
from cutcell.graph.midpoints import list_segments
from cutcell.graph.rays import Crossings, cast_rays
from cutcell.graph.segments import Runs, find_runs
from cutcell.graph.weld import weld
from cutcell.graph.winding import find_boundary


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
    return [
        cast_rays(prepared.vertices, prepared.faces, prepared.resolution, axis) for axis in range(3)
    ]


def decide(prepared: Prepared, crossings: list[Crossings], threshold: float = 0.5) -> list[Runs]:
    """Decide which segments are inside, along all three axes."""
    vertices, resolution = prepared.vertices, prepared.resolution
    boundary = find_boundary(prepared.faces)
    caps = cap_holes(vertices, boundary)
    needs = find_needs(caps, resolution, threshold)
    return [
        find_runs(vertices, found, boundary, caps, needs, resolution, axis, threshold)
        for axis, found in enumerate(crossings)
    ]


def midpoints(prepared: Prepared, crossings: list[Crossings]) -> np.ndarray:
    """List the midpoints between the first and last crossing of each ray, shape (q, 3)."""
    points = []
    for axis, found in enumerate(crossings):
        pieces = list_segments(found, prepared.resolution, closed=True)
        begins, ends = found.start[pieces.ray], found.start[pieces.ray + 1]
        between = (pieces.gap > begins) & (pieces.gap < ends)
        points.append(pieces.points(prepared.resolution, axis)[between])
    return np.concatenate(points)
