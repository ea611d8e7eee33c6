"""One slice of the lattice and its ray segments (paper section 3.1, figure "ray segments").

`build_graph` handles all rays at once and does not store the segments that it drops. Here the rays
of one slice are divided again, for display.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..geometry.weld import weld
from ..rig.checks import check_choice, check_integer, check_number
from ..rig.rig import TriangleMesh
from .lattice import Lattice
from .orientation.orient import oriented
from .rays import AXES, RayHits, cast_rays
from .winding import winding_number


@dataclass(frozen=True, eq=False)
class RaySlice:
    """Parallel rays in one plane of the lattice, divided at ray hits and lattice points.

    Positions are in the unit cube.

    Parameters
    ----------
    low, high : arrays, shape (s, 3), float64
        The ends of each segment, ray by ray, upward, without those at the wall of the cube,
        which lack an end.
    winding : array, shape (s,), float64
        The winding number at each segment's midpoint.
    kept : array, shape (s,), bool
        Whether it is at least tau.
    crossing : array, shape (c, 3), float64
        Ray hits.
    sign : array, shape (c,), int8
        +1 where a ray leaves through a triangle's back, -1 where it enters.
    triangle : array, shape (c,), int32
    lattice : Lattice
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    winding: NDArray[np.float64]
    kept: NDArray[np.bool_]
    crossing: NDArray[np.float64]
    sign: NDArray[np.int8]
    triangle: NDArray[np.int32]
    lattice: Lattice


def slice_rays(
    mesh: TriangleMesh,
    resolution: int,
    *,
    axis: int,
    normal: int,
    index: int,
    winding_threshold: float = 0.5,
    orient: bool = True,
) -> RaySlice:
    """Divide the rays of one slice of the lattice into segments.

    Parameters
    ----------
    mesh : TriangleMesh
    resolution : int
        R, as of `build_graph`.
    axis : int
        Which way the rays run: 0, 1, 2 for x, y, z.
    normal : int
        The axis perpendicular to the slice; not the same as `axis`.
    index : int
        Which slice, from 0 to R - 1: the one at (index + 1/2) / R.
    winding_threshold : float
        tau: segments with at least this winding number are kept.
    orient : bool
        As of `build_graph`.

    Returns
    -------
    RaySlice

    Raises
    ------
    ParameterError
        A parameter is out of its range, or the rays would leave the slice.

    References
    ----------
    Paper section 3.1, figure "ray segments".
    """
    lattice = Lattice.around(mesh, resolution)
    resolution = lattice.resolution
    check_choice("axis", axis, (0, 1, 2))
    check_choice("normal", normal, (0, 1, 2))
    if axis == normal:
        raise ParameterError(f"axis and normal are both {axis}; rays lie in their slice")
    index = check_integer("index", index, 0, resolution - 1)
    threshold = check_number("winding_threshold", winding_threshold, 0, 1)

    if orient:
        mesh = oriented(mesh)
    vertices, vertex_node = weld(lattice.to_unit(mesh.vertices))
    hits = cast_rays(vertices, vertex_node[mesh.faces], resolution, axis)
    u, v, along = AXES[axis]
    across = v if normal == u else u
    every = np.arange(resolution)
    rays = index * resolution + every if normal == u else every * resolution + index

    ends, number = _segments(hits, rays, resolution)
    low, high = (np.empty((len(number), 3)) for _ in range(2))
    for points, position in zip((low, high), ends.T, strict=True):
        points[:, normal] = (index + 0.5) / resolution
        points[:, across] = (number + 0.5) / resolution
        points[:, along] = position
    winding = winding_number(mesh, lattice.to_file((low + high) / 2))

    count = np.diff(hits.start)[rays]
    hit = np.concatenate([np.arange(*hits.start[[ray, ray + 1]]) for ray in rays])
    crossing = np.empty((len(hit), 3))
    crossing[:, normal] = (index + 0.5) / resolution
    crossing[:, across] = (np.repeat(every, count) + 0.5) / resolution
    crossing[:, along] = hits.position[hit]
    return RaySlice(
        low,
        high,
        winding,
        winding >= threshold,
        crossing,
        hits.sign[hit],
        hits.triangle[hit],
        lattice,
    )


def _segments(
    hits: RayHits, rays: NDArray[np.intp], resolution: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return both ends of each segment, shape (s, 2), and the index of its ray in the slice."""
    lattice = (np.arange(resolution) + 0.5) / resolution
    found, number = [], []
    for k, ray in enumerate(rays):
        position = hits.position[hits.start[ray] : hits.start[ray + 1]]
        ends = np.unique(np.concatenate([position, lattice]))
        found.append(np.stack([ends[:-1], ends[1:]], axis=1))
        number.append(np.full(len(ends) - 1, k))
    return np.concatenate(found), np.concatenate(number)
